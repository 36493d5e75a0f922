"""Maximum-likelihood fit of one oscillator to all records: the exact waveforms that fit their harmonics best.

The waveform of a record is the steady response of the oscillator (m, k, K_z, F_k) with a damping law, F_k and c by
default, under y = Y cos ωt. The stiffness k is given; the coefficients of the law, ρ = K_z^{−1/2} and, unless
it is given, the mass m are common to all records, Y and the phase ψ of the base are each record's own. Where the noise
is white, harmonics taken by least squares over whole cycles hold all the information on a steady motion, so that

    χ² = Σ |x_n(model) e^{inψ} − x_n|²/σ_n² + (Y(model) − Y)²/σ_Y² + (Yψ)²/σ_Y²

is that of the fit to all samples, whatever drives, whatever answers and however long the record is. Its minimum is the
estimate of largest likelihood; χ² itself says whether the records are those of such an oscillator. Any regime has its
exact waveform: one slip onset per half cycle, several, none. In ρ the rigid contact, ρ = 0, is a regular point.

The harmonics fix the phase of the base, too: a time by which the response lags the base in the record (a skew between
two channels) turns harmonic n by n times its angle, and can be left free.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..arrays import Array, Complexes, Mask
from ..law.law import Law
from ..law.steady import Response
from ..law.terms import FRICTION
from .lines import Lines, improbable
from .oscillator_fit import OscillatorFit
from .unknowns import Unknowns

_HARMONICS = 128  # odd ones of the waveform: beyond them lies less than 1e-6 of its velocity


@dataclass(frozen=True, eq=False)
class WaveformFit(OscillatorFit):
    """The oscillator whose waveforms fit the harmonics of n records best.

    lines : harmonics of the records.
    unknowns : names and places of the p unknowns.
    response : derivatives of the point by the data in units of their errors, (p, data): dp = response · d(data)/σ; the
    data of a record are |Y|, its phase, Re x_n, Im x_n.
    places : places of each record's data.
    freedom : degrees of freedom.
    undamped : keys of the coefficients that are at zero.
    evaluations : evaluations that the search took.
    """

    lines: tuple[Lines, ...]
    unknowns: Unknowns
    response: Array
    places: tuple[slice, ...]
    freedom: int
    undamped: tuple[str, ...]
    evaluations: int = 0

    @property
    def law(self) -> Law:
        """The damping law whose coefficients are fitted."""
        return self.unknowns.law

    @property
    def names(self) -> tuple[str, ...]:
        """Keys of the law's coefficients, then rho, m and delay."""
        return self.unknowns.names

    @property
    def F_k(self) -> float:
        """Friction force, N; the mean over the groups where it has some."""
        return float(self.unknowns.friction(self.point))

    @property
    def delay(self) -> float:
        """Time by which the response lags the base in the records in excess of the motion's phase, s."""
        return self.value("delay")

    @property
    def misfit(self) -> float:
        """χ² per degree of freedom."""
        return self.chi_square / max(1, self.freedom)

    @property
    def adequate(self) -> bool:
        """Whether such an oscillator explains the records within their noise."""
        return not improbable(self.chi_square, self.freedom, self.lines)

    @property
    def misfits(self) -> Array:
        """χ² of each record per datum, (n,)."""
        return np.array([np.mean(self.residual[place] ** 2) for place in self.places])

    @cached_property
    def responses(self) -> tuple[Response, ...]:
        """The motion of each record."""
        responses: list[Response] = []
        for i, one in enumerate(self.lines):
            responses.append(self.unknowns.response(self.point, i, one.omega))
        return tuple(responses)

    @property
    def slips(self) -> Mask:
        """Which records slip."""
        return np.array([response.slips for response in self.responses])

    @cached_property
    def waveforms(self) -> tuple[Waveform, ...]:
        """Waveform of each record, from which its features are read."""
        return tuple(_waveform(self, i) for i in range(len(self.lines)))


@dataclass(frozen=True, eq=False)
class Waveform:
    """The waveform of one record as features use it, with derivatives by the unknowns of the fit.

    fit : that it belongs to.   index : of the record.   response : its motion.
    onset : (V_s, t_s, λ), SI, λ = 4X − a the travel that sticking takes from 4X: 2L for one slip onset per half cycle.
    onset_slope : (3, p).   tail : harmonics x_n, n = 1, 3, 5 …, phases counted from the peak of y, m; tail_slope :
    their derivatives, (harmonics, p).
    """

    fit: WaveformFit
    index: int
    response: Response
    onset: Array
    onset_slope: Array
    tail: Complexes
    tail_slope: Complexes

    @property
    def F_k(self) -> float:
        """Friction force of the record, N."""
        return float(self.fit.point[self.fit.unknowns.at(self.index)[FRICTION]])

    @property
    def length(self) -> float:
        """L = 2F_k/K_z, m, freed of its bias of second order."""
        return 2.0 * self.F_k * (self.fit.rho**2 - self.fit.error("rho") ** 2)

    @property
    def length_slope(self) -> Array:
        """Derivatives of L by the unknowns, (p,)."""
        slope, at = np.zeros(self.fit.point.size), self.fit.unknowns.at(self.index)
        slope[at[FRICTION]] = 2.0 * self.fit.rho**2
        slope[at["rho"]] = 4.0 * self.F_k * self.fit.rho
        return slope


def _waveform(fit: WaveformFit, i: int) -> Waveform:
    """The waveform of record i."""
    one, response = fit.lines[i], fit.responses[i]
    onset, slope = fit.unknowns.onset(fit.point, i, one, response)
    tail, tail_slope = fit.unknowns.harmonics(
        fit.point, i, one, response, _HARMONICS, quickly=False
    )
    return Waveform(fit, i, response, onset, slope, tail, tail_slope)
