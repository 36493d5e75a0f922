"""Damping laws that are linear in their coefficients: their terms, and how an oscillator moves under them."""
