"""The thresholds of all tests on records, as probabilities, with their reasons.

The null hypothesis is a record of the oscillator with white noise. All tests together may doubt or reject at most 5 %
of the sets of sound records, as many as an interval of 95 % may miss. The share of a test is its threshold times the
number of its uses in a usual set (`tests/signals/test_thresholds.py` adds them up). A test that only chooses samples or
continues a search has no share: a false alarm costs time or a few samples.

A finding of a test causes doubt only by its possible effect on the numbers (`identification.answer.doubted`).
"""

from __future__ import annotations

import math

from scipy import special

NEVER = 2.9e-7
"""A difference anywhere among thousands of harmonics, channels and records; by chance in one of two million sets."""

SIGNIFICANT = float(-special.ndtri(NEVER))
"""Standard errors by which such a difference must stand out, five."""

RARE_LINE = -math.log(NEVER)
"""Height of a line of a spectrum of noise, relative to its mean, that is as rare, fifteen."""

P_DRIFT = 1e-6
"""Slow change of an amplitude; tested for each channel of each record, and reported with its size."""

P_OF_THE_MODEL = 1e-4
"""χ² of forced records about the oscillator, a residual of decays that resembles a motion, χ² that one oscillator for
all decays adds, χ² of half cycles about one F_k and c. Below it another answer or a narrower band is taken, or the
intervals grow, which costs accuracy."""

P_SHOWN = 6.3e-5
"""χ² of 16, four standard errors: slip, and a mass or a balance that contradicts the fit. Each changes the answer and
is tested a few times in a set."""

SHOWS = float(special.chdtri(1.0, P_SHOWN))
"""Least fall of χ² by which one additional unknown is significant, sixteen."""

CERTAIN = math.sqrt(SHOWS)
"""Standard errors by which a number or a harmonic is significant, four; by chance one in 16,000 is."""

P_STEP_BACK = 3e-4
"""χ² that new samples add while the start of a decay moves back, in about a hundred steps."""
