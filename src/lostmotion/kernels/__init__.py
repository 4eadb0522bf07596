"""Compiled kernels on floats and arrays; nothing else imports numba."""
