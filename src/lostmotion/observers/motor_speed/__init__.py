"""Observers of the load from the motor speed alone: each is a Stepper."""
