"""Observers with one sensor, the motor speed, and a fixed gain."""
