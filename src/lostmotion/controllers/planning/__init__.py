"""Costs and programs of plans, for predictive control."""
