"""How the oscillator moves: exactly (orbits, transients), and by the fixed steps that the paper's numbers come from."""
