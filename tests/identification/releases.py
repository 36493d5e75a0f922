"""The oscillator whose releases the tests of free decays begin with."""

from __future__ import annotations

from dataclasses import replace

from blind.decays import draw

# of an estimate: once in 16,000 of normal errors; the records are fixed
FAR = 4.0
PLUCKED = replace(
    draw(0),
    **{"m": 1.0, "c": 0.3, "k": 400.0, "K_z": 6000.0, "F_k": 0.1},
    **{"starts": (("pluck", 0.005),), "lead": (0.2,), "lasts": (5.0,), "pull": (0.4,)},
    **{"rate_hz": 500.0, "answers": ("displacement",), "noise": 0.01},
)
