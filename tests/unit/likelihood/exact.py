"""Exact samples of free decays, for tests of their fits."""

from __future__ import annotations

import numpy as np

from dampbalance import Oscillator, transient
from dampbalance.likelihood.decay import Decay


def exact_samples(point: np.ndarray, k: float, one: Decay) -> np.ndarray:
    """Samples of all channels of a decay without noise and offset; the last three unknowns are its start state."""
    F_k, c, rho, m = point[:4].tolist()
    x, v, w = point[-3:].tolist()
    oscillator = Oscillator(m, c, k, rho**-2, F_k)
    path = transient(oscillator, None, one.end - one.start, x=x, v=v, z=(w - 1.0) * oscillator.Z_m)
    states = [path.state(signal.t - one.start) for signal in one.signals]
    pairs = zip(states, one.signals, strict=True)
    return np.concatenate([(s.x, s.v, s.acceleration)[signal.order] for s, signal in pairs])
