"""What a model may have besides two masses, and which structure one has in words."""
