"""Drawings of setup and structure, made from the objects themselves."""
