"""Where descents begin: what a drivetrain, the slow motion, the frequency response or a grid says."""
