"""Observers that are steppers, compiled. Where to find what:

- the model f(x, u): ``two_mass_model``; what a sensor shows and how well: ``sensors``;
- predict and correct: ``kalman``, and of the filters that track parameters ``tracking``: its ``prediction``,
  ``measurement`` and ``correction``;
- contact at an edge of the gap: ``contact``; which sample is used: ``sensor_check``, in words ``verdicts``; missing
  torque or sensors: ``missing_inputs``;
- one file or folder per estimator, with its ``init`` and ``step``, which ``runner`` calls;
- all numbers by name: ``layout``, which kernels read by ``records``.
"""

from . import layout

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
#: (Layout.)
SIZES = {
    "extended_kalman": (layout.size(layout.PARAMETERS), 22),
    "interacting_models": (layout.size(layout.INTERACTING_PARAMETERS), 17),
    "moving_horizon": (layout.size(layout.HORIZON_PARAMETERS), 22),
    "neural_network": (layout.size(layout.NETWORK_PARAMETERS), 7),
    "sliding_mode": (layout.size(layout.SLIDING_PARAMETERS), 6),
    "super_twisting": (layout.size(layout.TWISTING_PARAMETERS), 7),
    "unscented_kalman": (layout.size(layout.PARAMETERS), 22),
}
