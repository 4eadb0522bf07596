"""The search for what predicts a recording best: its descents, their order, and the last fits."""
