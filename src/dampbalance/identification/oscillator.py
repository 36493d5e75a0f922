"""One oscillator fitted to all records by maximum likelihood: the answer where it holds, which the balance checks."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

from ..law.law import Law
from ..law.terms import FRICTION
from ..likelihood.base_harmonics import fit_records
from ..likelihood.coupling import Coupling, ac_coupling
from ..likelihood.mean_harmonics import Reading
from ..likelihood.steady_search import with_delay, with_mass
from ..likelihood.waveforms import WaveformFit
from ..project.wording import Remark
from ..reading.lines import Lines, improbable, linear_misfit
from .answer import Answer, answer_of_fit

CONTRADICTED = Remark("the mass given contradicts the records")
LATE = Remark("the response is out of time with the drive (see below): F_k and c carry that error")
COUPLED = Remark("the response is coupled (AC, see below): F_k and c carry that error")

NOT_CONVERGED = Remark(
    "the search for the best oscillator was ended before it converged: its numbers are no optimum"
)

_SHOWS = 16.0  # of χ²: what slip, or a delay, must explain to be there; four standard errors


@dataclass(frozen=True, eq=False)
class JointFit:
    """One oscillator fitted to all records.

    fit : the oscillator that responds most like them; None where no oscillator that slips does.
    linear : whether a linear oscillator explains them within their noise: nothing slips, or slip does not show.
    delayed : the fit with a delay between base and response.   late : whether the delay explains what noise does not.
    coupling : AC coupling of the response that explains what noise does not, better than a delay; None for none.
    mass : kg, as given, or None.   mass_fits : whether the records agree with it; if not, the fit has its own mass.
    """

    fit: WaveformFit | None
    linear: bool
    delayed: WaveformFit | None
    late: bool = False
    mass: float | None = None
    mass_fits: bool = True
    coupling: Coupling | None = None

    @property
    def waveforms_hold(self) -> bool:
        """Whether the waveforms of the fit are those of the records, so that the onset of slip and K_z are known."""
        return self.fit is not None and self.fit.adequate and not self.linear

    @property
    def notes(self) -> tuple[Remark, ...]:
        """What a reader must know before using the numbers of the fit."""
        fit = self.fit
        if fit is None or self.linear:
            return ()
        far = Remark(
            "the records are not those of such an oscillator: it is only the one that comes nearest"
        )
        of_zero = "is at its limit, zero: its standard error is not that of a normal distribution"
        at_zero = [Remark(f"the best {key} {of_zero}") for key in fit.undamped]
        heavy = () if self.mass_fits else (CONTRADICTED,)
        channel = [note for note, holds in ((COUPLED, self.coupling), (LATE, self.late)) if holds]
        search = () if fit.converged else (NOT_CONVERGED,)
        return (*heavy, *channel, *(() if fit.adequate else (far,)), *search, *at_zero)

    @property
    def answer(self) -> Answer | None:
        """The answer of the fit; None where no oscillator that slips fits."""
        fit, delayed = self.fit, self.delayed
        if fit is None or self.linear:
            return None
        return answer_of_fit(
            fit,
            fit.law.unknowns,
            self.notes,
            misfit_of_records=fit.misfits,
            delay_s=None if delayed is None else delayed.delay,
            delay_standard_error_s=None if delayed is None else delayed.error("delay"),
        )


def joint_fit(
    lines: Sequence[Lines],
    k: float,
    m: float | None = None,
    law: Law | None = None,
    near: WaveformFit | None = None,
    *,
    uncertainty: float = 0.0,
) -> JointFit:
    """The oscillator behind the records.

    The records determine the mass by themselves, nearly as well as scales would: a given mass that contradicts them is
    left out.

    k : N/m.   m : kg, if it is known.   law : of its damping; default, F_k and c.   near : a fit to these harmonics
    that has been found already.   uncertainty : standard uncertainty of k, as a part of it: a mass that differs by no
    more contradicts nothing.
    """
    law = law or Law()
    chi_square, freedom = linear_misfit(lines, k, law.terms)
    slips = improbable(chi_square, freedom, lines)
    fit = near if near is not None else fit_records(lines, k, law, thorough=slips)
    explained = 0.0 if fit is None else chi_square - fit.chi_square
    linear = explained < _SHOWS and not slips
    if fit is None or linear:
        return JointFit(fit, linear, None, mass=m)
    given = None if m is None else with_mass(fit, m)
    fits = given is not None and given.chi_square - fit.chi_square < _SHOWS
    off = math.hypot(fit.error("m"), uncertainty * fit.m)
    agrees = m is None or fits or abs(fit.m - m) < math.sqrt(_SHOWS) * off
    fit = given if given is not None and fits else fit
    # a damper to the base and one to the ground together make up for any delay
    delayed = None if {"c", "c_r"} <= set(law.unknowns) else with_delay(fit)
    late = delayed is not None and delayed.adequate and fit.chi_square - delayed.chi_square > _SHOWS
    coupling = ac_coupling(fit, _SHOWS)
    if coupling is not None and not coupling.fit.adequate:
        coupling = None
    if coupling is not None and late and delayed is not None:  # the likelier of the two
        late = delayed.chi_square < coupling.fit.chi_square
        coupling = None if late else coupling
    return JointFit(fit, linear, delayed, late, m, agrees, coupling)


def joined(readings: Sequence[Reading], joint: JointFit, law: Law | None = None) -> list[Reading]:
    """The readings with the waveforms of the fit.

    Where the waveforms do not hold, the readings have none; of the nearest oscillator they then have only the travel
    that its sticking takes.

    law : of the terms whose integrals are wanted.
    """
    wanted = () if law is None else tuple(s for s in law.terms if s not in (FRICTION, "c"))
    plain = [replace(reading, joint=True, shared=None, terms=wanted) for reading in readings]
    if joint.fit is None or joint.linear:
        return plain
    if joint.fit.adequate:
        pairs = zip(plain, joint.fit.waveforms, strict=True)
        return [replace(reading, shared=waveform) for reading, waveform in pairs]
    taken = [one.taken if one.slips else math.nan for one in joint.fit.responses]
    return [replace(reading, taken=part) for reading, part in zip(plain, taken, strict=True)]
