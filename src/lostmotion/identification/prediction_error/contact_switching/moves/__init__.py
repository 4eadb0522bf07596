"""Where a search goes from a candidate: other choices and parts, another backlash, random moves."""
