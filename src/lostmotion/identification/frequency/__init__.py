"""Frequency responses from recordings, and the two-mass parameters that fit them."""
