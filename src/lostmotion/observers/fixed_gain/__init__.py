"""Observers with a gain computed beforehand: each is a DiscreteSystem."""
