"""Damping laws that are linear in their coefficients, which of them are known or grouped; sliders in parallel."""
