"""Effect of a law's parameters on cost and modes, and the paths of a search."""
