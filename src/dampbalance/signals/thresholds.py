"""Every probability that decides something about records, with its reason: the one table of thresholds.

A test asks how probable what it sees is in records of the oscillator with white noise. All tests together may cast a
doubt on, or reject, at most 5 % of the sets of records that are sound, as many as an interval of 95 % may miss: each
has a share of it, its threshold times how often it is asked in a usual set (`tests/signals/test_thresholds.py` adds
them up). A test that only chooses which samples count, or where a search goes on, has none: by mistake it costs time or
a few samples, and doubts nothing.

An alarm is no doubt yet: what a test finds counts by what it may do to the numbers (`identification.answer.doubted`).
"""

from __future__ import annotations

import math

from scipy import special

NEVER = 2.9e-7
"""A difference that may lie anywhere among thousands of harmonics, channels and records: once in two million sets of
them it is chance."""

SIGNIFICANT = float(-special.ndtri(NEVER))
"""Standard errors by which a difference must stand out then, five."""

RARE_LINE = -math.log(NEVER)
"""Times the mean of a spectrum of noise, that a line of it has by chance as rarely, fifteen."""

P_DRIFT = 1e-6
"""Slow change of an amplitude: asked of each channel of each record, and reported with its size."""

P_OF_THE_MODEL = 1e-4
"""χ² of forced records about the oscillator, a residual of decays that looks like a motion, χ² that one oscillator for
all decays adds, χ² of half cycles about one F_k and c: below, another answer or a narrower band takes its place, or
intervals grow, which costs accuracy."""

P_SHOWN = 6.3e-5
"""χ² of 16, four standard errors: slip, and a mass or a balance that contradicts the fit.
Each changes what is answered, and is asked a few times in a set."""

SHOWS = float(special.chdtri(1.0, P_SHOWN))
"""Fall of χ² from which on one unknown shows then, sixteen."""

CERTAIN = math.sqrt(SHOWS)
"""Standard errors by which a number, or a harmonic, then stands out: by chance one in 16,000 does."""


P_STEP_BACK = 3e-4
"""χ² that new samples add where the start of a decay moves back: asked a hundred times on the way."""
