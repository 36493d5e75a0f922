"""Measured loops of force against displacement: the contact itself on a test machine, without an oscillator."""

from .answer import identify_loops as identify_loops
