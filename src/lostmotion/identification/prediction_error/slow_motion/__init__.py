"""What the slow motion of a recording tells, in which the drive turns as one body."""
