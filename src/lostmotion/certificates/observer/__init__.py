"""The error of an observer: how wrong it can be, proved in exact fractions."""
