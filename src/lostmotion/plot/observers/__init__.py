"""Figures of observers and of how they compare."""
