"""What the motor's sensor shows: its noise, the rounding of its counts, and the rows that count."""
