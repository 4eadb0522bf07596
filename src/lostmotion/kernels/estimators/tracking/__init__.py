"""What the filters that track parameters share: extended and unscented Kalman filter, moving horizon.

States: those of ``two_mass_model``, then torque_load, backlash, coulomb, and factors of the stiffness and of both
inverse inertias.
"""
