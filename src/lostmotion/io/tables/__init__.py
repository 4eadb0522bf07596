"""Files as tables of columns with units: CSV, MAT, matrices."""
