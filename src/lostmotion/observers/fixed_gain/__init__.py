"""Observers with a constant gain: each is a DiscreteSystem."""
