"""What a law is tuned by, from an identified drivetrain: gains of the PI controller, poles of the state feedback."""
