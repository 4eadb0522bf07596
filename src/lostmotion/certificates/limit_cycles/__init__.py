"""Limit cycles: where describing functions expect them, and the exact periodic orbits of the sampled loop."""
