"""Many variants of a drivetrain at once."""
