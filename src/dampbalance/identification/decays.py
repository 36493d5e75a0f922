"""F_k, c and K_z from free decays: by a fit of all samples, and by rows of half cycles weighted by their covariance.

Each pair of neighbouring half cycles gives a row a F_k + b c = W, which is read from the samples (`half_cycles.py`).
Neighbouring rows share a half cycle: the root of their covariance makes rows independent before they are solved.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import lru_cache, partial
from typing import TYPE_CHECKING, Any, ClassVar, Never

import numpy as np
from scipy import special

from ..arguments import NUMBERS, number
from ..balance import TERMS, Rows
from ..findings.finding import UNBOUNDED, Finding
from ..findings.words import sentence
from ..fit.decay import DecayFit, offset_of, with_noise_of
from ..fit.decay_departures import SPEED, as_pendulum, weighed
from ..fit.scattering_mean import ScatteringMean
from ..fit.search import fit_all, in_the_band, profiled, separate_fits, sound, to_the_end
from ..fit.select import REFITTED, Selection
from ..project.options import Stated, options_of, with_options
from ..project.spelling import spelled
from ..project.wording import visible
from ..records.channel import EXCITATIONS, ORDERS, Channel
from ..records.coordinate import ROTATION, TRANSLATION
from ..records.mapping import MappingLike
from ..records.measured import as_records
from ..records.record import Record
from ..signals.bursts import NoDecay, Signal, bursts_of, noise_of, sharpest, too_few_samples
from ..signals.checks import contradiction_in, plausible
from ..signals.conditioning import in_equal_steps
from ..signals.cycles import clipped, flat_tops
from ..signals.drive import stands_still
from ..signals.log_decrement import SwingDamping, damping_of
from ..signals.one_thread import one_thread
from ..signals.thresholds import P_OF_THE_MODEL, SHOWS
from ..solver import NORMAL_95
from .answer import (
    BALANCE,
    UNKNOWN,
    USELESS,
    Answer,
    Interval,
    ParameterEstimate,
    answer_of_fit,
    averaged,
)
from .balance_check import compared, forbidden
from .balance_rows import Balanced, as_answer, solved
from .diagnosis import on_mass
from .half_cycles import DecayRows, rows_of
from .law_comparison import compare_decay_laws
from .level import Column
from .request import read_request, with_stiffness_by_mass
from .result import Picture, Result
from .rigs import require_rotation
from .screen import implied, measured_block, plain
from .sensitivities import Fault
from .stated import widened, with_stated_uncertainties
from .weighing import said_of, weighed_of

if TYPE_CHECKING:
    from ..records.measured import RecordLike


_WIDE = USELESS / NORMAL_95  # relative standard error
# largest error of integrals of smoothed samples as a part of the work: exact accelerations at 40 samples a cycle
_ACCURACY = 5e-3
# half cycles, and K_z/k, below which a motion that no oscillator fits shows no contact
_FEWEST, _LOOSE = 2, 1e-2


@dataclass(frozen=True, eq=False, repr=False)
class DecayBasis:
    """What the answers to records of free decays rest on.

    fit : of one oscillator to all samples, from which the balance takes the stick distance.
    half_cycles : rows of the balance.   damping : frequency and damping over the amplitude, from the swings.
    """

    fit: DecayFit
    half_cycles: DecayRows
    damping: Sequence[SwingDamping] = ()

    kind: ClassVar[str] = "ring-down"
    mass_tests: ClassVar[bool] = True
    columns: ClassVar[Mapping[str, Column]] = {
        "mode": Column("mode"),
        "X_m": Column("X", "mm"),
        "frequency_Hz": Column("f", "Hz", "frequency_standard_error_Hz"),
        "damping_ratio": Column("ζ", "%", "damping_ratio_standard_error"),
        "loss_factor": Column("η"),
        "cycles": Column("cycles"),
    }

    def document(self, found: Result[Any]) -> dict[str, Any]:
        """Return the standard deviation of the friction forces, 0 where all decays share one, and the decays of each
        record."""
        decays = [(one.source, self._decay(i)) for i, one in enumerate(self.fit.decays)]
        return {
            "F_k_scatter_N": self.fit.friction.scatter,
            "records": [
                {"record": name, "decays": [decay for source, decay in decays if source == name]}
                for name in found.sources
            ],
        }

    def _decay(self, i: int) -> dict[str, Any]:
        one, (turns, errors) = self.fit.decays[i], self.half_cycles.turns[i]
        still, friction = self.fit.sticks_from(i), one.key("F_k")
        # the position at which the spring is slack, if a channel is a displacement
        rest = next((offset_of(signal) for signal in one.signals if signal.order == 0), None)
        return {
            "decay": i + 1,
            "start_s": one.start,
            "end_s": one.end,
            "F_k_N": self.fit.value(friction),
            "F_k_standard_error_N": self.fit.error(friction),
            "sticks_from_s": one.start + still if math.isfinite(still) else None,
            "rest_m": None if rest is None else self.fit.value(rest),
            "noise_rms": {signal.quantity: signal.noise for signal in one.signals},
            "turns_s": turns[:, 0],
            "turns_m": turns[:, 1],
            "turns_standard_error_m": errors,
        }

    def levels(self, found: Result[Any]) -> list[SwingDamping]:
        """Return frequency and damping over the amplitude from the swings, independent of the fit."""
        return [*self.damping]

    def with_fault(self, found: Result[Any], name: str, fault: Fault) -> dict[str, float]:
        """Return the numbers of an answer with a fault.

        m, c, k, K_z and F_k, all times the same number, are an oscillator of the same motion, and F_k is in proportion
        to the motion. A delay has no effect, since the start of a decay is not known.
        """
        fit, k = self.fit, 1.0 + fault.stiffness
        if fit.error("m") == 0.0 and (change := fault.mass - fault.stiffness):
            fit = _with_mass(fit, (1.0 + change) * fit.m) or fit
        values = {symbol: getattr(fit, symbol) for symbol in ("F_k", "c", "K_z", "m")}
        if name == BALANCE:  # its rows have the stick of the fit
            own = self.half_cycles if fit is self.fit else rows_of(fit)
            values |= balanced(own).values
        scale = {"F_k": k * (1.0 + fault.response)}
        return {symbol: scale.get(symbol, k) * value for symbol, value in values.items()}

    def pictures(self, found: Result[Any]) -> dict[str, Picture]:
        """Return each decay with the motion fitted to it, and the rows of the balance, if there are any."""
        from . import pictures as drawn  # slow to import

        pictures = {"decays": Picture(drawn.decays, (self.fit, self.half_cycles.turns))}
        if self.half_cycles.decay.size:
            pictures["balance"] = Picture(drawn.balance, (found.approaches, False))
        if self.damping:
            pictures["damping"] = Picture(drawn.damping, (self.damping,))
        return pictures


def _counted(n: int, what: str) -> str:
    return f"{n} {what}{'s' * (n != 1)}"


@with_options
def identify_decays(
    records: RecordLike | Sequence[RecordLike],
    stiffness: Stated | None = None,
    *,
    mapping: MappingLike = None,
    mass: Stated | None = None,
    laws: bool = False,
    pendulum: bool = False,
    **unknown: Never,
) -> Result[DecayBasis]:
    """Identify F_k, c and K_z from records of free decays, one or several after releases or blows; one is enough.

    Each pair of neighbouring half cycles gives a row a F_k + b c = W of the energy balance. The answer is the
    maximum-likelihood fit of one oscillator to all samples, checked by the balance.

    records : what `read_records` returns or takes.
    stiffness, mapping : as for `identify_forced`.
    The options of the signature, which `help` describes.

    Raises ValueError (for a record, `RecordError`), which names the argument or the record, what is wrong and the
    remedy: for an argument outside its range, and a record whose excitation channel keeps moving, whose channels
    contradict each other, or that holds no free decay.

    >>> from dampbalance import Oscillator, identify_decays, measured_ring_down
    >>> osc = Oscillator(m=2.42, c=1.0, k=2310.0, K_z=20800.0, F_k=0.5)
    >>> decay = measured_ring_down(osc, x=0.01, rate_hz=500.0, duration=2.0, noise=0.001)
    >>> found = identify_decays(decay, stiffness=2310.0)
    >>> {symbol: round(found.values[symbol], 1) for symbol in ("F_k", "c")}
    {'F_k': 0.5, 'c': 1.0}
    """
    given, read = options_of(locals()), tuple[Record, ...]()
    try:
        read, asked_for = read_request("ring-down", records, mapping, given)
        found = _of_records(read, asked_for)
    except ValueError as error:  # the swings show the damping without a fit
        if stiffness is None and given.get("mass") is None:
            read = as_records(records, mapping=mapping, kind="ring-down")
        if damping := _damping_of(read):
            levels, of = [one.document() for one in damping], read[0].coordinate
            error.add_note(plain([measured_block(DecayBasis, levels, of)], None).rstrip())
        raise
    return replace(found, basis=replace(found.basis, damping=_damping_of(read)))


@one_thread
def _damping_of(records: Sequence[Record]) -> list[SwingDamping]:
    """Return frequency and damping over the amplitude of the largest decay of all records; empty without one."""
    found: list[list[SwingDamping]] = []
    for record in (one.corrected() for one in records):
        signals = [_signal(record, channel, 0, []) for channel in record.responses]
        with suppress(NoDecay):
            lead = sharpest(signals)
            found.append(damping_of(lead, bursts_of(lead)))
    return max(found, key=lambda rows: rows[0].X if rows else 0.0, default=[])


def _of_records(records: tuple[Record, ...], options: Mapping[str, Any]) -> Result[DecayBasis]:
    """Return the answers to records that are read.   options : by the keys of a configuration."""
    k, mass = options["stiffness_N_per_m"], options["mass_kg"]
    if k is None:
        options, k = with_stiffness_by_mass(partial(_of_records, records), options)
        mass = None
    identified = partial(
        identify_decay_records,
        [record.corrected() for record in records],
        k,
        mass=mass,
        mass_error=options["mass_standard_error_kg"] or 0.0,
        stiffness_error=options["stiffness_standard_error_N_per_m"] or 0.0,
        laws=options["laws"],
    )
    if options["pendulum"]:
        require_rotation(records)
        outcome = identified(pendulum=True)
    elif records[0].coordinate == ROTATION:
        outcome = _pendulum_if_likelier(identified)
    else:
        outcome = identified()
    odd = [words.about(record.name) for record in records for words in record.warnings]
    odd += outcome.odd
    return with_stated_uncertainties(
        replace(outcome, odd=tuple(odd), records=records, options=options)
    )


@one_thread
def identify_decay_records(
    records: Sequence[Record],
    k: float,
    *,
    mass: float | None = None,
    mass_error: float = 0.0,
    stiffness_error: float = 0.0,
    laws: bool = False,
    pendulum: bool = False,
) -> Result[DecayBasis]:
    """Return F_k, c and K_z from records of free decays, one or more.

    k : stiffness, N/m.
    mass : kg, if it is known; the fit takes it if the decays agree with it and know it less well.
    mass_error, stiffness_error : standard uncertainties of the mass, kg, and of k, N/m.
    laws : whether to compare damping laws.
    pendulum : whether the restoring torque is k sin θ.

    Raises ValueError for a stiffness or a mass that is not positive, and a record whose excitation channel moves, whose
    channels contradict each other, or that holds no decay that slips.
    """
    number("stiffness", k, NUMBERS["k"])
    if mass is not None:
        number("mass", mass, NUMBERS["m"])
    fits: list[DecayFit] = []
    warnings: list[Finding] = []
    offsets = 0
    for record in records:
        if record.driven and not stands_still(record.excitation.values):
            raise ValueError(
                f"{record.name}: {visible(record.excitation.name)} moves: this is no free decay, and forced records "
                f"and free decays are not identified together: give each alone, without {spelled('kind', 'ring-down')}"
            )
        odd: list[Finding] = []
        channels = enumerate(record.responses, offsets)
        signals = [_signal(record, channel, number, odd) for number, channel in channels]
        warnings += [words.about(record.name) for words in odd]
        try:
            if len(signals) > 1:
                first = max(bursts_of(sharpest(signals)), key=lambda burst: burst.swing)
                if contradiction := contradiction_in(signals, first, record.coordinate):
                    raise ValueError(f"{record.name}: {contradiction}")
            separate, bursts = separate_fits(record.name, signals, k, pendulum)
            if not separate:
                step = min(signal.dt for signal in signals)
                raise NoDecay(too_few_samples(bursts[0].period / step))
        except NoDecay as error:
            raise ValueError(_unclear(record, k, str(error))) from None
        warnings += [
            Finding("no decay", {"time": float(burst.turn)}, of=record.name) for burst in bursts
        ]
        offsets += len(signals)
        fits += separate
    common, left_out = fit_all(fits)
    if common is None:
        raise ValueError(
            f"{records[0].name}: no oscillator explains its free decays; check the stiffness and the units"
        )
    warnings += [
        Finding("other decay", {"start": one.start, "end": one.end}, of=one.source)
        for one in left_out
    ]
    fit, agrees = with_noise_of(to_the_end(common)), True
    if not fit.adequate:
        fit = in_the_band(fit) or fit
    if mass is not None:
        own, off = fit.error("m"), abs(fit.m - mass)
        agrees = off < math.sqrt(SHOWS) * math.hypot(own, stiffness_error / k * fit.m, mass_error)
        if mass_error < own and off < math.sqrt(SHOWS) * math.hypot(own, mass_error):
            fit = _with_mass(fit, mass) or fit
        elif not agrees:
            warnings.append(on_mass(fit, mass))
    selection = weighed(fit)
    fit = profiled(selection.fit)
    warnings += said_of(selection)
    if records[0].coordinate == TRANSLATION:
        omega = 2.0 * math.pi * fit.natural_frequency_hz
        starts = [(fit.value(one.key("x")), fit.value(one.key("v"))) for one in fit.decays]
        largest = max(math.hypot(x, v / omega) for x, v in starts)
        warnings += plausible(0.0, largest, omega, "force")  # without a base
    moves = [min(fit.sticks_from(i), one.end - one.start) for i, one in enumerate(fit.decays)]
    halves = sum(int(2.0 * t / one.period) for t, one in zip(moves, fit.decays, strict=True))
    if not sound(fit) and (halves < _FEWEST or fit.K_z < _LOOSE * k):
        numbers = {"k": k, "halves": halves, "share": fit.residual_share}
        why = Finding("no friction contact", numbers)
        names = ", ".join(dict.fromkeys(one.source for one in fit.decays))
        raise ValueError(f"{names}: {sentence(why, records[0].coordinate)}")
    rig = implied(fit, mass if agrees else None)
    sources = tuple(record.name for record in records)
    outcome = _solved(fit, selection, rows_of(fit), sources, rig, warnings)
    return replace(outcome, laws=compare_decay_laws(fit)) if laws else outcome


def _pendulum_if_likelier(identified: Callable[..., Result[Any]]) -> Result[Any]:
    """Return the answer to decays of a rotation: as a pendulum, where a linear spring leaves more than noise and k_3
    explains that no better.

    identified : returns the answer; with pendulum=True, for a restoring torque k sin θ.
    """
    answers: list[Result[Any]] = []
    errors: list[ValueError] = []
    for pendulum in (False, True):
        try:
            answers.append(identified(pendulum=pendulum))
        except ValueError as error:
            errors.append(error)
        if answers and not pendulum and _linear(answers[0]):
            break
    if not answers:
        raise errors[0]
    *plain, found = answers
    fit = found.basis.fit
    noisy = not fit.white and any(one.basis.fit.white for one in plain)
    if noisy or not fit.problem.pendulum or not as_pendulum(fit):
        return answers[0]
    return replace(found, odd=(*found.odd, Finding("pendulum")))


def _linear(found: Result[Any]) -> bool:
    """Return whether a linear spring explains the decays."""
    of_k_3 = (one.weight for one in found.weighed if one.name == "k_3")
    return found.basis.fit.white and max(of_k_3, default=0.0) < REFITTED


def _unclear(record: Record, k: float, why: str) -> str:
    """Return the words on a record without a decay.   k : N/m.   why : the reason, if it is known."""
    channel = visible(record.excitation.name) if record.driven else ""
    drives = ", ".join(map(record.coordinate.noun, EXCITATIONS))
    found = Finding("no decay found", {"channel": channel, "drives": drives, "k": k, "why": why})
    return f"{record.name}: {sentence(found, record.coordinate)}"


def _signal(record: Record, channel: Channel, offset: int, warnings: list[Finding]) -> Signal:
    """Return a channel of the mass in equal time steps.   offset : its number among the channels of all records."""
    channel = in_equal_steps(channel, warnings)
    t, values = channel.t, channel.values
    limits = flat_tops(values)
    order = ORDERS[channel.quantity]
    noise = noise_of(values)
    return Signal(channel.quantity, order, t, values, noise, offset, limits, channel.missing)


@lru_cache(maxsize=4)  # asked for with each answer and fault
def _with_mass(fit: DecayFit, mass: float) -> DecayFit | None:
    """Return the fit with a mass that is given, from the same minimum."""
    return fit.problem.climb(fit.parameters.held("m").moved(m=mass))


def _solved(
    fit: DecayFit,
    selection: Selection,
    rows: DecayRows,
    sources: tuple[str, ...],
    rig: Sequence[Finding],
    warnings: Sequence[Finding],
) -> Result[DecayBasis]:
    """Return the result: the fit with its notes, the solved rows as its check, the given findings on the rig, and the
    given warnings."""
    solution = balanced(rows)
    misfit, freedom, estimates = solution.misfit, solution.freedom, solution.estimates
    fit_notes = list[Finding]()
    if not sound(fit):  # even in the band of the mode
        fit_notes.append(Finding("no one decays", {"share": fit.residual_share}, UNBOUNDED))
    notes = [*fit_notes]
    wide = any(fit.error(s) > _WIDE * abs(fit.value(s)) for s in TERMS)
    if fit.problem.band is not None and wide:
        fit_notes.append(_other_motion(fit))
    if freedom > 0 and special.chdtrc(freedom, solution.chi_square) < P_OF_THE_MODEL:
        notes.append(Finding("half cycles differ", {"misfit": misfit}))
    if not estimates:
        notes.append(Finding("few half cycles", {"halves": rows.halves}))
    if abs(fit.F_k) < NORMAL_95 * fit.error("F_k"):
        fit_notes.append(Finding("decays without friction"))
        notes.append(fit_notes[-1])
    ringing = math.sqrt((fit.k + fit.K_z) / fit.m) / (2.0 * math.pi)
    dt = max(signal.dt for one in fit.decays for signal in one.signals)
    if 0.5 / dt < ringing < math.inf and not fit.K_z_interval[1] > 2.0 * fit.K_z:
        of_ringing = {"hertz": ringing, "rate": 1.0 / dt}
        fit_notes.append(Finding("rings", of_ringing, {"K_z": math.inf}))
    clipped_signals = {
        f"{signal.quantity} of {one.source}": Finding(
            "clipped decay", {"quantity": signal.quantity}, of=one.source
        )
        for one in fit.decays
        for signal in one.signals
        if clipped(signal.values)
    }
    notes += forbidden(estimates, list(clipped_signals), "negative decay")
    reference = averaged(answer_of_fit(fit, TERMS, fit_notes), selection)
    numbers = (rows.decay + 1).tolist()
    answer = as_answer(
        *(BALANCE, solution, rows.rows, tuple(f"decay {i}" for i in numbers)),
        {**dict.fromkeys(TERMS, UNKNOWN), "K_z": reference.K_z},
        {"decay": numbers},
        notes=tuple(notes),
        merit={"misfit": misfit, "degrees_of_freedom": freedom},
    )
    # the balance attributes all of the motion to friction and viscous damping; a speed names no departure
    departures = [name for name in fit.further if name != SPEED]
    lacks = ["clipped"] if clipped_signals else [*["other motion"] * (not fit.white), *departures]
    widest = _among_models(answer, selection)
    judged = None if clipped_signals else reference  # clipped swings are no check
    check, doubts = compared(answer if lacks else widest, judged, lacks, _ACCURACY)
    doubts = [one for one in doubts if one.largest > USELESS]
    decays = {(one.source, one.of_cycles or one.start) for one in fit.decays}
    return Result(
        basis=DecayBasis(fit, rows),
        k=fit.k,
        sources=sources,
        estimates={BALANCE: widest},
        reference=reference,
        weighed=weighed_of(selection),
        odd=(*warnings, *doubts, *clipped_signals.values()),
        check=[check],
        head=f"{_counted(len(sources), 'record')} with {_counted(len(decays), 'free decay')}, "
        f"{_counted(rows.halves, 'half cycle')} in the balance; values with 95 % intervals",
        rig=[*rig, *_excerpts_of(fit), *_scatter_of(fit)],
    )


def _other_motion(fit: DecayFit) -> Finding:
    """Return the finding, for a fit in the band of the mode, on the other motion in the samples and its main
    frequency."""
    whole = replace(fit, problem=replace(fit.problem, band=None))
    residuals = ((signal.dt, off) for _, signal, off in whole.residuals())
    dt, off = max(residuals, key=lambda one: float(np.linalg.norm(one[1])))
    lines = np.abs(np.fft.rfft((off - off.mean()) * np.hanning(off.size)))
    hertz = float(np.argmax(lines)) / (off.size * dt)
    return Finding("other motion", {"hertz": hertz, "share": fit.residual_share})


def _among_models(answer: Answer, selection: Selection) -> Answer:
    """Return the answer of the balance, whose rows are those of the plain model, with intervals widened by the changes
    that other models make, by weight."""
    plain = np.array([selection.plain.value(key) for key in selection.keys])
    with np.errstate(divide="ignore", invalid="ignore"):
        off = np.array([one.values for one in selection.models]) / plain - 1.0
    changes = np.sqrt(np.average(off**2, 0, selection.weights))
    return widened(answer, {"models": dict(zip(selection.keys, changes.tolist(), strict=True))})


def _excerpts_of(fit: DecayFit) -> list[Finding]:
    """Return a finding where excerpts of decays are fitted."""
    excerpts = [one for one in fit.decays if one.of_cycles]
    cycles = math.fsum((one.end - one.start) / one.period for one in excerpts)
    longest = max((one.of_cycles for one in excerpts), default=0)
    of = {"count": len(excerpts), "cycles": cycles, "all": longest}
    return [Finding("decay excerpts", of)] if excerpts else []


def _scatter_of(fit: DecayFit) -> list[Finding]:
    """Return a finding on the friction forces of the decays where they do not share one."""
    if fit.frictions.size == 1:
        return []
    mean, keys = fit.friction, dict.fromkeys(one.key("F_k") for one in fit.decays)
    forces = tuple((fit.value(key), fit.error(key)) for key in keys)
    of_mean = {"scatter": mean.scatter, "share": mean.scatter / mean.value}
    return [Finding("friction differs", {"forces": forces, **of_mean})]


def balanced(rows: DecayRows) -> Balanced:
    """Return F_k and c from the rows; where decays have separate friction forces, F_k is their mean."""
    a, b = rows.rows.terms.values()
    forces = np.unique(rows.friction)
    terms = {str(one): np.where(rows.friction == one, a, 0.0) for one in forces} or {"0": a}
    of_rows = Rows({**terms, "c": b}, rows.rows.W)
    each = solved(of_rows, lambda _: [rows.covariance], [math.inf], free=rows.free).scaled()
    if forces.size == 1 or not each.estimates:
        return replace(each, estimates=dict(zip(TERMS, each.estimates.values(), strict=False)))
    mean = ScatteringMean.of(np.array([*each.values.values()])[:-1], each.covariance[:-1, :-1])
    F_k = ParameterEstimate(mean.value, mean.error, Interval(*mean.interval))
    shares = np.full(forces.size, 1.0 / forces.size)
    averages = np.array([[*shares, 0.0], [*(0.0 * shares), 1.0]])
    covariance = averages @ each.covariance @ averages.T
    covariance[0, 0] = mean.error**2
    return replace(each, estimates={"F_k": F_k, "c": each.estimates["c"]}, covariance=covariance)
