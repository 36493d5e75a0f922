"""The oscillator behind all records, by the fit of largest likelihood: the yardstick, and what it says of them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

from ..law.law import Law
from ..law.terms import FRICTION
from ..reading.fitting import fit_oscillator, with_delay, with_mass
from ..reading.lines import Lines, improbable, linear_misfit
from ..reading.noisy import Reading
from ..reading.waveforms import WaveformFit

_SHOWS = 16.0  # of χ²: what slip, or a delay, must explain to be there; four standard errors


@dataclass(frozen=True, eq=False)
class Whole:
    """What the records are, taken together.

    fit : the oscillator that responds most like them; None where none does that slips.
    linear : whether a linear oscillator explains them within their noise: nothing slips, or it does not show.
    delayed : the fit with a delay between base and response; late : whether that explains what noise does not.
    mass : kg, as given, or None.   mass_fits : whether the records agree with it; if not, the fit has its own.
    """

    fit: WaveformFit | None
    linear: bool
    delayed: WaveformFit | None
    late: bool = False
    mass: float | None = None
    mass_fits: bool = True

    @property
    def mass_given(self) -> bool:
        """Whether the fit takes the mass as given."""
        return self.mass is not None and self.mass_fits

    @property
    def waveforms_hold(self) -> bool:
        """Whether the waveforms of the fit are those of the records."""
        return self.fit is not None and self.fit.adequate and not self.linear


def whole_oscillator(
    lines: Sequence[Lines],
    k: float,
    m: float | None = None,
    law: Law | None = None,
) -> Whole:
    """The oscillator behind the records.   k : N/m.   m : kg, if it is known.   law : of its damping; default, F_k, c.

    The records tell the mass by themselves, nearly as well as a balance: one that contradicts them is left out.
    """
    law = law or Law()
    chi_square, freedom = linear_misfit(lines, k, law.terms)
    slips = improbable(chi_square, freedom, lines)
    fit = fit_oscillator(lines, k, law, thorough=slips)
    explained = 0.0 if fit is None else chi_square - fit.chi_square
    linear = explained < _SHOWS and not slips
    if fit is None or linear:
        return Whole(fit, linear, None, mass=m)
    known = None if m is None else with_mass(fit, m)
    fits = known is not None and known.chi_square - fit.chi_square < _SHOWS
    fit = known if known is not None and fits else fit
    # a damper to the base and one to the ground together make up for any delay
    delayed = None if {"c", "c_r"} <= set(law.unknowns) else with_delay(fit)
    late = delayed is not None and delayed.adequate and fit.chi_square - delayed.chi_square > _SHOWS
    return Whole(fit, linear, delayed, late, m, m is None or fits)


def joined(readings: Sequence[Reading], whole: Whole, law: Law | None = None) -> list[Reading]:
    """The readings with the waveforms of the fit; where they do not hold, without any, and with no more of the nearest
    oscillator than the travel that its sticking takes.   law : the terms whose integrals are wanted."""
    wanted = () if law is None else tuple(s for s in law.terms if s not in (FRICTION, "c"))
    if whole.fit is None or whole.linear:
        return [replace(reading, joint=True, shared=None, terms=wanted) for reading in readings]
    if not whole.fit.adequate:
        return [
            replace(
                reading,
                joint=True,
                shared=None,
                terms=wanted,
                taken=response.taken if response.slips else math.nan,
            )
            for reading, response in zip(readings, whole.fit.responses, strict=True)
        ]
    return [
        replace(reading, joint=True, shared=waveform, terms=wanted)
        for reading, waveform in zip(readings, whole.fit.waveforms, strict=True)
    ]
