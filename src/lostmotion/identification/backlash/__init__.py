"""Backlash: from a locked load, from two encoders, and whether a recording excites it."""
