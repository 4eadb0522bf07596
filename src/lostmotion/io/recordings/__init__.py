"""From the columns of a file to a checked recording."""
