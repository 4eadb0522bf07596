"""The design of a test before it is run."""
