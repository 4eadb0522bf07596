"""Observers that are steppers: one file per filter, and what they share."""

#: Kind of estimator → module of this folder with its ``init`` and ``step``.
MODULES = {
    "extended_kalman": "extended_kalman",
    "interacting_models": "interacting_models.step",
    "moving_horizon": "moving_horizon.step",
    "neural_network": "motor_speed.neural_network",
    "sliding_mode": "motor_speed.sliding_mode",
    "super_twisting": "motor_speed.super_twisting",
    "unscented_kalman": "unscented_kalman",
}
