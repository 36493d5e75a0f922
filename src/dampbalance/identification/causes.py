"""What the fit of one oscillator to all records leaves, tested against the likeliest causes, one at a time.

A cause changes the harmonics of the model by a direction, in units of their errors, times an unknown amount: a score
test (`fit/score.py`) says what amount the records show, and what it does to F_k, c and K_z. The directions
are the derivatives of the model by its nuisances (`fit/nuisances.py`), with which the oscillator can be fitted again.

One cause is special. A contact that yields gradually has nearly the harmonics of one that yields at once, with another
stiffness: of what lies between, little more than the loss while it yields shows in a record. The sum of the squares of
the residuals hardly notices; the one direction in which such a contact differs, and the one sign, tell the most. All
such contacts nearly share it: that of Iwan with a uniform distribution, whose corner is a parabola, stands for those of
Dahl, Bouc–Wen and several sliders.

A motion relative to the base that was taken for absolute, or the other way round, is off by the whole base motion y,
which is too much for a score test: the oscillator is fitted again, to x + y or x − y.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

from scipy import special

from ..fit.nuisances import in_other_frame
from ..fit.oscillator_fit import OscillatorFit
from ..fit.score import Departure
from ..fit.steady_search import fit_records
from ..fit.waveforms import WaveformFit
from ..law.law import Law
from ..motion.law_decays import ADDED
from ..project.wording import Remark, larger_by, listed
from ..records.measurement import ABSOLUTE, RELATIVE
from ..signals.mean_harmonics import Reading
from ..solver import NORMAL_95
from .oscillator import AS_WELL

# Probability of a cause by chance in records of the oscillator, half of it that of the contact that yields gradually.
_CHANCE = 0.005
_MOST = 0.3  # of what noise does not explain: a cause that is named as the likeliest
_ROUNDEST = 1.5  # a Dahl contact, which is twice as stiff after a reversal as the nearest that yields at once
_MATTERS = 3.0  # standard errors by which another contact may change K_z, unsaid
_LEAST = 0.03  # of K_z
DELAY = "a delay between the channels (skew, or clocks that differ)"
COUPLING = "an AC coupling (high-pass) of a channel"
DRIVE = "a wrong gain of the drive"
OF_CHANNELS = (DELAY, COUPLING, DRIVE)
"""Causes in the channels and not in the oscillator."""
GRADUAL = ADDED[-1]
"""The cause that hardly shows: see above."""

WORDS = {
    "delay": DELAY,
    "corner": COUPLING,
    "gain": DRIVE,
    "low_pass": "a low-pass filter in the response",
    "friction_level": "a friction force that changes with the level",
    "friction_speed": "a friction force that changes with the speed",
    "gradual": GRADUAL,
    "c_2": "damping that grows with the speed (compare the laws)",
    "k_3": "a spring that is not linear",
}
"""Each nuisance of a fit as the cause of what it explains."""

_GRADUALLY = "yields gradually (Dahl, Bouc–Wen, several contacts)"


def departures(fit: WaveformFit) -> list[Departure]:
    """What each cause would explain; the amount of the gradual contact is 1 for an Iwan contact."""
    return [replace(one, symbol=WORDS[name]) for name, one in fit.departures.items()]


def likeliest(fit: WaveformFit, tested: Sequence[Departure]) -> Departure | None:
    """The cause that explains most of what a fit leaves, if it is more than chance would give it.

    tested : by `departures`.
    """
    shown = [one for one in tested if one.p < _level(one, len(tested))]
    best = max(shown, key=lambda one: abs(one.size), default=None)
    if best is None:
        return None
    beyond_noise = fit.chi_square - fit.freedom
    return best if fit.adequate or best.size**2 > _MOST * beyond_noise else None


def _level(one: Departure, count: int) -> float:
    """The p below which a cause shows; a contact that yields more suddenly than at once is no cause."""
    if one.symbol != GRADUAL:
        return 0.5 * _CHANCE / max(count - 1, 1)
    return _CHANCE if one.value > 0.0 else 0.0


def gradual_contact(tested: Sequence[Departure], scale: float = 1.0) -> Departure | None:
    """The contact that yields gradually, where it shows and explains more than anything else that was tested.

    scale : of the errors, where the residual is like a motion.
    """
    best = max(tested, key=lambda one: abs(one.size), default=None)
    if best is None or best.symbol != GRADUAL or not best.value > 0.0:
        return None
    return best if 2.0 * special.ndtr(-best.size / scale) < _CHANCE else None


def as_well(explained: float, tested: Sequence[Departure], named: Sequence[str]) -> list[Departure]:
    """Causes that explain about as much of χ² (`AS_WELL`), to first order.   named : those that are named already."""
    return [
        one
        for one in tested
        if one.symbol not in named
        and one.size**2 > explained - AS_WELL
        and (one.symbol != GRADUAL or one.value > 0.0)
    ]


def in_others(words: Sequence[str]) -> str:
    """The clause on causes that explain the records as well; empty for none."""
    explain = "explain" if len(words) > 1 else "explains"
    return (
        f"; {listed(words, 'or')} {explain} it as well, with χ² within {AS_WELL:g}" if words else ""
    )


def words_of(one: Departure) -> str:
    """A cause in words."""
    return f"a contact that {_GRADUALLY} and not at once" if one.symbol == GRADUAL else one.symbol


def remark_on(one: Departure, fit: OscillatorFit, others: Sequence[str] = ()) -> Remark:
    """The sentence on a departure from an oscillator that explains the records within their noise otherwise.

    others : causes that explain as much, in words.
    """
    changes = _changes(one, fit, one.value)
    remedy = "calibrate the channels" if one.symbol in OF_CHANNELS else "the model has none"
    words = (
        f"the records show {words_of(one)}: that explains {one.size**2:.0f} of χ², by chance with p = {one.p:.1g}"
        f"{in_others(others)}; {remedy}"
    )
    if one.symbol == GRADUAL:
        share = min(changes["K_z"], 1.0)
        words = (
            f"{words}, and its K_z is that of the nearest one that yields at once: after a reversal the contact is "
            f"roughly {larger_by(abs(share))} {'stiffer' if share > 0.0 else 'softer'}; identify the distribution of "
            "its yield forces from more levels"
        )
    return Remark(words, doubts={symbol: abs(part) for symbol, part in changes.items()})


def condition_on_contact(fit: OscillatorFit, tested: Iterable[Departure]) -> list[str]:
    """A sentence where K_z depends on the contact yielding at once by more than its interval shows, and the records
    could not tell one that yields gradually from it; none where they could.

    It is a condition and no doubt, as of all numbers on the gains: K_z and its interval are those of the contact that
    was asked for, which moves like one that yields gradually and is stiffer after a reversal.   tested : all that was
    tested.
    """
    for one in tested:
        if one.symbol != GRADUAL or fit.rigid:
            continue
        most = min(max(one.value, 0.0) + NORMAL_95 * one.error, _ROUNDEST)
        part = _changes(one, fit, most).get("K_z", 0.0)
        if part > max(_LEAST, _MATTERS * fit.K_z_error / fit.K_z):
            return [
                "K_z and its interval are conditional on a contact that yields at once, which these records cannot "
                f"test: one that {_GRADUALLY} moves alike, and is stiffer by up to {larger_by(part)} right "
                "after a reversal. To use K_z for that stiffness, test it with less noise, or with levels at which the "
                "contact hardly slips."
            ]
    return []


def _changes(one: Departure, fit: OscillatorFit, value: float) -> dict[str, float]:
    """Return the relative change of the numbers of a fit with a coefficient of this value, by symbol."""
    parts = {s: by * value / (fit.value(s) or 1.0) for s, by in one.slopes.items()}
    if "rho" in parts:
        # after a reversal the contact is as much stiffer as its corner is rounded
        parts["K_z"] = -2.0 * parts.pop("rho") + (value if one.symbol == GRADUAL else 0.0)
    return parts


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


def fit_in_other_frame(readings: Sequence[Reading], k: float, law: Law | None) -> OtherFrame | None:
    """The fit to all responses in the other frame; None where it does not hold, or there is no other frame.

    Where a force drives, the base is at rest; where channels of both kinds are averaged, they test each other.

    k : N/m.   law : of the damping; default, F_k and c.
    """
    channels = {q for reading in readings for q in reading.steady.channels}
    absolute, relative = (tuple(q for q in of if q in channels) for of in (ABSOLUTE, RELATIVE))
    if "force" in channels or (absolute and relative):
        return None
    lines = [in_other_frame(reading.lines) for reading in readings]
    # where it holds, the nearest starts lead there: no wide search for what most records are not
    fit = fit_records(lines, k, law, thorough=False)
    if fit is None or not fit.adequate:
        return None
    return OtherFrame(bool(absolute), absolute or relative, fit)
