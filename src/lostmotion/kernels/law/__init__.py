"""A discrete law: its step as machine code, the check of its inputs, samples of its error."""
