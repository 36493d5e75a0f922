"""The integrals of a balance over a period of any steady response, by quadrature between its events."""

from __future__ import annotations

import numpy as np

from dampbalance.law.terms import term
from dampbalance.motion.events import PHASE_S, PHASE_T

NODES, WEIGHTS = np.polynomial.legendre.leggauss(12)
PANEL = 0.1  # rad of the fastest oscillation


def of_motion(symbol, orbit):
    """g = ∮ h ẋ dt of a term; friction's is the travel in slip, a of Eq. (7a)."""
    force, k, omega = term(symbol).force, orbit.oscillator.k, orbit.motion.omega
    return orbit.a if force is None else around(orbit, lambda v, w, y: force(v, w, k, omega) * v)


def input_work(orbit):
    """W = ∮ k y ẋ dt, J: Eq. (5), for any law."""
    return around(orbit, lambda v, w, y: orbit.oscillator.k * y * v)


def around(orbit, integrand):
    """∮ of a function of (ẋ, ẏ, y) that is the same in both half cycles."""
    motion, osc = orbit.motion, orbit.oscillator
    edges, total = np.append(orbit.phases[:, PHASE_T], 0.5 * motion.period), 0.0
    for begin, end, s in zip(edges, edges[1:], orbit.phases[:, PHASE_S], strict=False):
        fastest = motion.omega + np.sqrt((osc.k + osc.K_z * (s == 0.0)) / osc.m)
        panels = np.linspace(begin, end, 2 + int((end - begin) * fastest / PANEL))[:, None]
        width = np.diff(panels, axis=0)
        t = panels[:-1] + 0.5 * width * (1.0 + NODES) + orbit.theta / motion.omega
        w = -motion.omega * motion.Y * np.sin(motion.omega * t)
        total += float(np.sum(width * WEIGHTS * integrand(orbit.state(t).v, w, motion.y(t))))
    return total
