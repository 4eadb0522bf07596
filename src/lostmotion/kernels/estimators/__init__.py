"""Observers that are steppers, compiled. Where to find what:

- the model f(x, u): ``two_mass_model``; what a sensor shows and how well: ``sensors``;
- predict and correct: ``kalman``, and of the filters that track parameters ``tracking``: its ``prediction``,
  ``measurement`` and ``correction``;
- contact at an edge of the gap: ``contact``; which sample is used: ``sensor_check``, in words ``verdicts``; missing
  torque or sensors: ``missing_inputs``;
- one file or folder per estimator, with its ``init`` and ``step``, which ``runner`` calls;
- all numbers by name: ``layout``, which kernels read by ``records``.
"""
