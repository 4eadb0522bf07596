"""Prediction errors of an observer and their derivatives, over a whole recording."""
