"""Moving-horizon estimator over a piecewise-linear model.

The cost over the horizon — distance from the arrival estimate, from the model, from the measurements, each in its own
standard deviations — is minimised by Gauss–Newton: contact states and slopes are taken along the trajectory of the last
pass, and the linear problem that remains is solved exactly by a Kalman filter forwards and its adjoint backwards. So a
later sample revises which contact an earlier one was in.
"""
