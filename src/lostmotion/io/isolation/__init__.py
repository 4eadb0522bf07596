"""Foreign binary formats are read in a process of their own: a damaged file ends that one, not the user's."""
