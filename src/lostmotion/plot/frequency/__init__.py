"""Figures of frequency responses and mode shapes."""
