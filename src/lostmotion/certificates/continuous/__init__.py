"""Laws in continuous time, and the loops that they make."""
