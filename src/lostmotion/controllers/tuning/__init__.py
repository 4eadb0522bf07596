"""Tuning of the PI speed controller from an identified drivetrain: by formula, or by its step across the gap."""
