"""Contacts that yield gradually: what one Jenkins element is mistaken for. `other_motion.py` has their equations."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.interpolate import CubicSpline

from .other_motion import Contact, Rig, steady_motion

_SLIDERS = 16  # that stand for a distribution


def two_sliders(K_z: float, F_k: float) -> Contact:
    """Return a contact of which half of the stiffness yields at a quarter of the friction."""
    return np.array([(0.5 * K_z, 0.25 * F_k, 0.0), (0.5 * K_z, 0.75 * F_k, 0.0)])


def iwan(K_z: float, F_k: float) -> Contact:
    """Return sliders of one stiffness whose yield forces are spread evenly between zero and the largest (Iwan 1966)."""
    share = (2.0 * np.arange(_SLIDERS) + 1.0) / _SLIDERS**2
    return np.array([(K_z / _SLIDERS, part * F_k, 0.0) for part in share])


CONTACTS: dict[str, Callable[[float, float], Contact]] = {
    "Bouc–Wen, n = 1": lambda K_z, F_k: np.array([(K_z, F_k, 2.0)]),
    "Bouc–Wen, n = 2": lambda K_z, F_k: np.array([(K_z, F_k, 3.0)]),
    "two sliders": two_sliders,
    "Iwan": iwan,
    # LuGre's with a friction that does not depend on the speed
    "Dahl": lambda K_z, F_k: np.array([(K_z, F_k, 1.0)]),
}
"""By name: the contact of a stiffness K_z after a reversal and a friction F_k in the end."""


def steady_on(
    contact: Contact, m: float, c: float, k: float, Y: float, omega: float
) -> CubicSpline:
    """Return (x, x′, x″) of the steady period on a contact as a periodic function of ωt, SI."""
    return steady_motion(Rig(m, c, k, Y=Y, omega=omega), contact)
