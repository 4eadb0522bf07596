"""State feedback as a law: gains and what holds a steady state, friction by the set-point, the torque limit."""
