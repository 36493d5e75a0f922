"""Motion of the oscillator: exact (orbits, transients), and by the fixed steps that the paper's numbers come from."""
