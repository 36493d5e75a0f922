"""Measured loops of force against displacement: the contact itself on a test machine, without an oscillator."""

from .answer import contact as contact
from .answer import friction_coefficient as friction_coefficient
from .answer import history as history
from .answer import identify_loops as identify_loops
from .answer import sliders as sliders
