"""What a torque goes through before or behind a law: a notch against an eigenmode, a ramp of what is asked for."""
