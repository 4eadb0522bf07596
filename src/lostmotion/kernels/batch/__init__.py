"""Many variants of a drivetrain on all cores."""
