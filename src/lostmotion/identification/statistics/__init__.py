"""Regression that the rooms beside this one share."""
