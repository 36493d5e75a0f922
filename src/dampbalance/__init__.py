"""Damping of a forced oscillator with compliant contact, identified by balancing energy.

After Liang & Feeny, *Balancing energy to estimate damping in a forced oscillator with compliant contact*,
DETC2010-28049.
"""

from .model import BaseMotion, Oscillator
from .motion.orbit import NoSteadyOrbit, Orbit, steady_orbit
from .motion.orbits import Orbits, steady_orbits
from .motion.regime import Regime
from .motion.states import State
from .motion.transient import Trajectory, transient

__version__ = "0.1.0"

__all__ = [
    "BaseMotion",
    "NoSteadyOrbit",
    "Orbit",
    "Orbits",
    "Oscillator",
    "Regime",
    "State",
    "Trajectory",
    "steady_orbit",
    "steady_orbits",
    "transient",
]
