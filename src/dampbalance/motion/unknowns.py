"""The unknowns of an oscillator by which its motions are differentiated, and their places; SI units."""

OSCILLATOR_UNKNOWNS = ("F_k", "c", "rho", "m")
"""ρ = K_z^{−1/2}: the rigid contact, ρ = 0, is a regular point."""

F_K, C, RHO, M = range(len(OSCILLATOR_UNKNOWNS))
