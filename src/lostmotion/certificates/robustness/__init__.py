"""How far a loop is from instability: margins in every contact state, simulated variants, the worst start."""
