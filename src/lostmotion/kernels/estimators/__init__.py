"""Observers that are steppers: one file per filter, and what they share."""

#: Kind of estimator → module of this folder with its ``init`` and ``step``.
MODULES = {
    "extended_kalman": "extended_kalman",
    "interacting_models": "interacting_models.step",
    "moving_horizon": "moving_horizon",
    "neural_network": "neural_network",
    "sliding_mode": "sliding_mode",
    "super_twisting": "super_twisting",
    "unscented_kalman": "unscented_kalman",
}
