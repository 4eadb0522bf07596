"""Figures of controllers."""
