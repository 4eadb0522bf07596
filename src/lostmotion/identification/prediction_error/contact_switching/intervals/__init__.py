"""What widens the intervals beside chance: other fits of the same model, and inertias that the model lacks."""
