"""Contacts that yield gradually in part, and steady motions on them by an independent integrator of sliders."""

from __future__ import annotations

import math

import numpy as np

from blind.gradual import CONTACTS, steady_on

OMEGA = 2.0 * math.pi * 3.5


def contact_of(osc, part):
    """A Jenkins element and, in parallel, sliders of twice its stiffness, which have a part of the friction."""
    jenkins = np.array([((1.0 - part) * osc.K_z, (1.0 - part) * osc.F_k, 0.0)])
    if not part:
        return jenkins
    return np.vstack([jenkins, CONTACTS["Iwan"](2.0 * part * osc.K_z, part * osc.F_k)])


def harmonics_on(contact, osc, Y, count):
    """x_n, n = 1, 3 …, of the steady motion, by its independent integration."""
    motion = steady_on(contact, osc.m, osc.c, osc.k, Y, OMEGA)
    phases = np.arange(4096) * (2.0 * math.pi / 4096)
    return 2.0 * np.fft.rfft(motion(phases)[0])[1 : 2 * count : 2] / 4096
