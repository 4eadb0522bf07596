"""Friction: from constant speeds, breakaway, a torque step, or inverse dynamics of a rigid drive."""
