"""What the fit of one oscillator to all records leaves, tested against the likeliest causes, one at a time.

A cause changes the harmonics of the model by a direction d, in units of their errors, times an unknown amount. Of the
residual r of the fit, whose unknowns have the derivatives J, it explains

    (dᵀr)²/(dᵀ M d),   M = 1 − J J⁺,

of χ²: Rao's score test, which asks for no further fit. Where the oscillator holds this is χ² with one degree of freedom
whatever d is, so that a direction needs to be no better than roughly right. With the amount −dᵀr/(dᵀ M d) of it, the
unknowns would be others by J⁺d times that amount: what the cause does to F_k, c and K_z.

A force δF that the model lacks moves the mass by δx_n = −δF_n/(k − mn²ω² + inωc) while it slides.

A motion relative to the base that was taken for absolute, or the other way round, is off by the whole base motion y,
which is too much for a score test: the oscillator is fitted again, to x + y or x − y.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ..arrays import Array, Complexes, Integers
from ..law.law import Law
from ..law.terms import FRICTION
from ..likelihood.base_harmonics import fit_records
from ..likelihood.mean_harmonics import Reading
from ..likelihood.waveforms import WaveformFit
from ..records.measurement import ABSOLUTE, RELATIVE

_SHOWS = 25.0  # of χ²: five standard errors, for one of eight causes by chance in 200,000 sets
_MOST = 0.3  # of what noise does not explain: a cause that is named as the likeliest
_NEW = 1e-6  # of the square of a direction: what the unknowns of the fit must leave of it
_PHASES = 1024  # of a cycle
_FALLING = 0.1  # of the largest speed


@dataclass(frozen=True, slots=True)
class Cause:
    """A cause of a misfit.

    words : what it is.   explained : of χ².   changes : what it does to each number, as parts of them, by symbol.
    """

    words: str
    explained: float
    changes: dict[str, float]


def likeliest(fit: WaveformFit) -> Cause | None:
    """The cause that explains most of what a fit leaves, if it is more than chance would give it."""
    free = np.flatnonzero(np.any(fit.response != 0.0, axis=1))
    inverse = fit.response[free]
    jacobian: Array = np.asarray(np.linalg.pinv(inverse), dtype=np.float64)
    causes, keys = [], (*fit.law.unknowns, "rho")
    for words, of_records in _directions(fit, jacobian, free):
        d = np.zeros(fit.residual.size)
        for place, part in zip(fit.places, of_records, strict=True):
            d[place][2:] = part
        left = d - jacobian @ (inverse @ d)
        square = float(left @ d)
        if not square > _NEW * float(d @ d):
            continue
        along = float(d @ fit.residual)
        moved = np.zeros(fit.point.size)
        moved[free] = inverse @ d * (along / square)
        parts = {key: moved[fit.names.index(key)] / (fit.value(key) or 1.0) for key in keys}
        parts["K_z"] = -2.0 * parts.pop("rho")
        changes = {symbol: abs(float(part)) for symbol, part in parts.items()}
        causes.append(Cause(words, along**2 / square, changes))
    best = max(causes, key=lambda cause: cause.explained, default=None)
    if best is None or best.explained < _SHOWS:
        return None
    beyond_noise = fit.chi_square - fit.freedom
    return best if fit.adequate or best.explained > _MOST * beyond_noise else None


@dataclass(frozen=True, slots=True)
class OtherFrame:
    """Responses that fit where they are taken against the base instead of the ground, or the other way round.

    relative : whether they are relative to the base, and were taken for absolute.   quantities : what they were taken
    for.   fit : of the oscillator to the motions as they are.
    """

    relative: bool
    quantities: tuple[str, ...]
    fit: WaveformFit

    @property
    def names(self) -> tuple[str, ...]:
        """The quantities that they are."""
        names = dict(zip(ABSOLUTE, RELATIVE, strict=True))
        names = names if self.relative else {there: here for here, there in names.items()}
        return tuple(names[q] for q in self.quantities)


def in_other_frame(readings: Sequence[Reading], k: float, law: Law | None) -> OtherFrame | None:
    """The fit to all responses in the other frame; None where it does not hold, or there is no other frame.

    Where a force drives, the base is at rest; where channels of both kinds are averaged, they test each other.

    k : N/m.   law : of the damping; default, F_k and c.
    """
    channels = {q for reading in readings for q in reading.steady.channels}
    absolute, relative = (tuple(q for q in of if q in channels) for of in (ABSOLUTE, RELATIVE))
    if "force" in channels or (absolute and relative):
        return None
    sign = 1.0 if absolute else -1.0
    lines = []
    for one in (reading.lines for reading in readings):
        y = np.zeros(max(int(one.n[-1]), one.base.size + 1) + 1, dtype=np.complex128)
        y[1], y[2 : one.base.size + 2] = one.Y, one.base
        lines.append(replace(one, x=one.x + sign * y[one.n]))
    # where it holds, the nearest starts lead there: no wide search for what most records are not
    fit = fit_records(lines, k, law, thorough=False)
    if fit is None or not fit.adequate:
        return None
    return OtherFrame(bool(absolute), absolute or relative, fit)


def _directions(
    fit: WaveformFit, jacobian: Array, free: Integers
) -> Iterator[tuple[str, Sequence[Array]]]:
    """Each cause with the change that it makes in the real and imaginary parts of the harmonics of each record, over
    their errors."""
    lines, motions = fit.lines, [_motion(fit, i) for i in range(len(fit.lines))]
    fastest = max(float(np.abs(v).max()) for _, v, _ in motions)

    def in_errors(changes: Iterable[Complexes]) -> list[Array]:
        scaled = [dx / one.x_error for dx, one in zip(changes, lines, strict=True)]
        return [np.concatenate([dx.real, dx.imag]) for dx in scaled]

    yield (
        "a delay between the channels (skew, or clocks that differ)",
        in_errors(-1j * one.n * one.omega * one.x for one in lines),
    )
    yield (
        "an AC coupling (high-pass) of a channel",
        in_errors(1j * one.x / (one.n * one.omega) for one in lines),
    )
    sizes = np.log([one.Y for one in lines])
    where = [np.flatnonzero(free == at[FRICTION]) for at in fit.unknowns.at]
    if len(lines) > 1 and all(w.size for w in where):
        yield (
            "a friction force that changes with the level",
            [
                size * jacobian[place, w[0]][2:]
                for size, place, w in zip(sizes - sizes.mean(), fit.places, where, strict=True)
            ],
        )
    for words, force in _FORCES.items():
        forces = (force(x, v / fastest, gradual) for x, v, gradual in motions)
        yield words, in_errors(_moved(fit, i, of) for i, of in enumerate(forces))


_FORCES: Mapping[str, Callable[[Array, Array, Array], Array]] = {
    "a friction force that changes with the speed": lambda x, v, gradual: (
        np.sign(v) * np.exp(-np.abs(v) / _FALLING)
    ),
    "a contact that yields gradually (Dahl, Bouc–Wen, several contacts) and not at once": (
        lambda x, v, gradual: gradual
    ),
    "damping that grows with the speed (compare the laws)": lambda x, v, gradual: v * np.abs(v),
    "a spring that is not linear": lambda x, v, gradual: x**3,
}
"""Forces that the model lacks, of x, of ẋ over the largest speed, and of that of a contact that yields gradually."""


def _motion(fit: WaveformFit, i: int) -> tuple[Array, Array, Array]:
    """(x, ẋ, force of a contact that yields gradually less that of the model's) over a cycle from a peak of the base.

    After a reversal at −X both contacts start at −F_k. Over the distance u from there, the model's force rises by K_z u
    up to F_k, that of a Dahl contact by dF/du = K_z(1 − F/F_k)/2.
    """
    orbit = fit.responses[i].orbit
    osc = orbit.oscillator
    t = orbit.motion.period * np.arange(_PHASES // 2) / _PHASES
    x, v, *_ = (np.concatenate([half, -half]) for half in orbit.state(t))
    sign = np.where(v < 0.0, -1.0, 1.0)
    u = np.maximum(sign * x + float(np.abs(x).max()), 0.0)
    jenkins = np.minimum(osc.K_z * u - osc.F_k, osc.F_k)
    dahl = osc.F_k * (1.0 - 2.0 * np.exp(-0.5 * osc.K_z * u / osc.F_k))
    return x, v, sign * (dahl - jenkins)


def _moved(fit: WaveformFit, i: int, force: Array) -> Complexes:
    """Change of the harmonics of a record by a further force on the mass that opposes its motion."""
    one = fit.lines[i]
    spectrum = 2.0 * np.fft.rfft(force)[one.n] / force.size
    at = 1j * one.n * one.omega
    turned = np.exp(1j * one.n * fit.point[fit.unknowns.at[i]["psi"]])
    return np.asarray(-spectrum * turned / (fit.k + at * fit.c + at**2 * fit.m))
