"""Proofs for every drivetrain of a box: cells, their search, and what they say."""
