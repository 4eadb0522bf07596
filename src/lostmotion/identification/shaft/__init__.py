"""The shaft alone: its stiffness from torque and twist, its damping from a ring-down."""
