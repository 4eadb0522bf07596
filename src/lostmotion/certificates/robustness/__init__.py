"""How far a loop is from instability: margins in every contact state, shares of the gap, peaks."""
