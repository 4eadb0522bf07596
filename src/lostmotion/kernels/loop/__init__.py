"""A drivetrain with laws in the loop."""
