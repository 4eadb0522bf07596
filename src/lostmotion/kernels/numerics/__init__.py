"""Small vectors in registers, and addresses."""
