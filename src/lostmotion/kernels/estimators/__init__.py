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

#: Numbers of parameters and outputs: a step reads and writes its arrays at fixed places, whatever their lengths are.
#: (Numerics.)
SIZES = {
    "extended_kalman": (119, 22),
    "interacting_models": (123, 17),
    "moving_horizon": (121, 22),
    "neural_network": (150, 7),
    "sliding_mode": (130, 6),
    "super_twisting": (133, 7),
    "unscented_kalman": (119, 22),
}
