"""Drivetrains without a gap."""
