"""Damping laws that are linear in their coefficients: their terms, and which of them are known or grouped."""
