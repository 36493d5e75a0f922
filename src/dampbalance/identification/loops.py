"""The contact from measured loops of force against displacement: quantities of each cycle and level, the answer, and
the rows of the balance.

A cycle is a row of the balance, ∮ f dx = a F_k + b c with a = 4(X − Z_m) and b = ∮ ẋ² dt; the shape of the loop gives
K_z. There is no oscillator: neither mass nor the stiffness of a spring is needed.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, ClassVar, Never

import numpy as np

from ..arrays import Array
from ..balance import Rows
from ..findings.finding import Finding
from ..fit.loop_design import MOST_BLOCKS, Design, force_of, slope_of
from ..fit.loops import DIFFER, SLIDERS, WITHIN, LoopFit, fit_gradual, weigh, with_late_motion
from ..fit.select import Selection, select
from ..law.terms import FRICTION
from ..project.options import Stated, options_of, with_options
from ..project.wording import listed
from ..records.mapping import MappingLike
from ..signals.loops import FEWEST_CYCLES, SAME_LEVEL, Loop, levels_of, measures
from ..signals.one_thread import one_thread
from ..signals.thresholds import CERTAIN
from ..solver import NORMAL_95
from .answer import (
    CONFIDENCE,
    UNKNOWN,
    USELESS,
    Answer,
    Balance,
    Interval,
    ParameterEstimate,
    covariance_in,
    covariance_of,
    stiffness_of,
)
from .level import Column, Level
from .loop_records import read_loops
from .request import read_request
from .result import Picture, Result
from .sensitivities import Fault
from .stated import with_stated_uncertainties
from .weighing import weighed_of

if TYPE_CHECKING:
    import pandas as pd

    from ..records.measured import RecordLike

_STIFFEST, _SOFTEST = 0.02, 0.5  # r/X of sliders, where the stiffest and the softest are left out
_SETTLED = 3.0  # scatters from the later cycles, within which a cycle is steady
_NO_SLIDER = 0.2  # of F_k or of the loss, from which on a residual bounds no number of the fit
MOST_SAMPLES = 60_000
"""Samples that a contact is fitted to; of longer records runs of cycles are."""


_COMPARED = {"one slider": "one slider predicts", "gradual": "many sliders predict"}


@dataclass(frozen=True, eq=False, repr=False)
class LoopBasis:
    """The data and fits behind the answers to measured loops.

    loops : of all records.
    fits : of each contact, by name, the one to use first.
    normal_force : N, with its standard uncertainty; None if it was not given.
    """

    loops: tuple[Loop, ...]
    fits: Mapping[str, LoopFit]
    normal_force: tuple[float, float] | None

    kind: ClassVar[str] = "loops"
    mass_tests: ClassVar[bool] = False
    columns: ClassVar[Mapping[str, Column]] = {
        "level": Column("record"),
        "X_m": Column("X", "mm"),
        "cycles": Column("n"),
        "W_J": Column("W", "J"),
        "W_over_4X_N": Column("W/4X", "N"),
        "secant_stiffness_N_per_m": Column("k_s", "N/mm"),
        "equivalent_damping_ratio": Column("ζ_eq", "%"),
        "force_at_largest_displacement_N": Column("F+", "N"),
        "force_at_smallest_displacement_N": Column("F−", "N"),
    }

    def document(self, found: Result[Any]) -> dict[str, Any]:
        """Return the entries of the document for measured loops: sliders, μ, the history of the cycles, the records."""
        mu, interval = friction_coefficient(found)
        contacts = {}
        for name, fit in self.fits.items():
            r, kappa = fit.contact.present
            contacts[name] = {"r_m": r, "kappa_N_per_m": kappa, "residual_rms_N": fit.rms}
        return {
            "contacts": contacts,
            "friction_coefficient": mu,
            "friction_coefficient_interval": interval,
            "history": loop_history(found).to_dict("list"),
            "records": [
                {"record": loop.name, "cycles": loop.cycles, "timed": loop.timed}
                | {"force_sign_changed": loop.flipped}
                for loop in self.loops
            ],
        }

    def levels(self, found: Result[Any]) -> list[Level]:
        """Return the mean cycle of each amplitude in each record."""
        levels, c, fit = [], loop_contact(found)["c"], self.fits.get(found.answer.name)
        for loop in self.loops:
            _, b, W = row_of(loop, fit) if fit else (0.0, 0.0, math.nan * loop.lost)
            X = np.where(loop.closed, loop.amplitudes, math.nan)
            cycles, samples = np.array([X, loop.lost, W - c * b]), np.bincount(loop.cycle[loop.own])
            for own in levels_of(loop.amplitudes):
                if own.size > 1 and loop.first == 1:  # the first cycle begins on the virgin curve
                    own = own[own > 0]
                duration = float(np.median(samples[own]) * (loop.t[1] - loop.t[0]))
                omega = 2.0 * math.pi / duration if loop.timed else math.nan
                X, W, friction = cycles[:, own].mean(axis=1).tolist()
                more = measures(X, W, loop.peaks[own].mean(axis=0))
                zeta = more["equivalent_damping_ratio"]
                more |= {"cycles": own.size, "loss_factor": 2.0 * zeta, "Q": 0.5 / zeta}
                levels.append(Level(loop.name, X, omega, W, friction, more))
        return levels

    def with_fault(self, found: Result[Any], name: str, fault: Fault) -> dict[str, float]:
        """Return the numbers of an answer with a fault: all are proportional to the force, c and K_z inversely to the
        displacement; a delay is fitted again."""
        if not (fit := self.fits.get(name)):
            return {}
        if fault.late and all(loop.timed for loop in self.loops):
            fit = with_late_motion(fit, fault.late)
        scale = dict.fromkeys(("c", "K_z"), (1.0 + fault.drive) / (1.0 + fault.response))
        scale[FRICTION] = 1.0 + fault.drive
        return {s: fit.value(s) * by for s, by in scale.items() if s in fit.parameters}

    def pictures(self, found: Result[Any]) -> dict[str, Picture]:
        """Return force over displacement with the model and the backbone, loss and stiffness against the amplitude,
        and, with a fit, the history of the cycles."""
        from . import loop_pictures as drawn  # slow to import

        fit, cycles = self.fits.get(found.answer.name), loop_history(found)
        shown = {
            "loops": Picture(drawn.loops, (self.loops, fit, found.levels)),
            "loss": Picture(drawn.loss, (self.loops, fit, cycles)),
        }
        return shown | ({"history": Picture(drawn.history, (cycles,))} if fit else {})


def loop_contact(found: Result[LoopBasis]) -> dict[str, float]:
    """Return F_k, K_z and c of measured loops as keyword arguments of `Oscillator`, to predict a response.

    With a mass m on a spring k it is `steady_orbit(Oscillator(m=m, k=k, **loop_contact(found)), motion)`. An unknown or
    negative c becomes zero. If the contact yields gradually, use `loop_sliders`.

    >>> import numpy as np
    >>> from dampbalance import identify_loops, loop_contact
    >>> from dampbalance.law.contact import play
    >>> t = np.linspace(0.0, 10.0, 4001)
    >>> x = 1e-3 * np.sin(2.0 * np.pi * t)
    >>> force = 5e4 * play(x, 2e-4)[0]  # a slider that gives way at 0.2 mm
    >>> found = identify_loops({"time_s": t, "displacement_m": x, "force_N": force})
    >>> [*loop_contact(found)], round(loop_contact(found)["F_k"], 1)
    (['F_k', 'K_z', 'c'], 10.0)
    """
    known = {symbol: found.values[symbol] for symbol in (FRICTION, "K_z")}
    return {**known, "c": float(np.fmax(found.values.get("c", 0.0), 0.0))}


def loop_sliders(found: Result[LoopBasis]) -> dict[str, Array]:
    """Return the sliders of measured loops, r (m) and κ (N/m), as keyword arguments of `sliders_orbit`.

    Use it to predict a response if the contact yields gradually or its knee is rounded:

        sliders_orbit(Oscillator(m=m, k=k, K_z=1.0, F_k=0.0, c=loop_contact(found)["c"]), motion, **loop_sliders(found))

    >>> import numpy as np
    >>> from dampbalance import identify_loops, loop_sliders
    >>> from dampbalance.law.contact import play
    >>> t = np.linspace(0.0, 10.0, 4001)
    >>> x = 1e-3 * np.sin(2.0 * np.pi * t)
    >>> force = 5e4 * play(x, 2e-4)[0]  # a slider that gives way at 0.2 mm
    >>> found = identify_loops({"time_s": t, "displacement_m": x, "force_N": force})
    >>> r, kappa = loop_sliders(found).values()
    >>> round(float(r @ kappa), 1)
    10.0
    """
    fits = found.basis.fits
    fit = fits[found.answer.name]
    fit = fit if fit.contact.plain else fits["gradual"]
    return dict(zip(("r", "kappa"), fit.contact.present, strict=True))


def friction_coefficient(found: Result[LoopBasis]) -> tuple[float, Interval]:
    """Return the friction coefficient μ = F_k/N of measured loops and its 95 % interval; NaN without a normal force.

    >>> import numpy as np
    >>> from dampbalance import identify_loops, friction_coefficient
    >>> from dampbalance.law.contact import play
    >>> t = np.linspace(0.0, 10.0, 4001)
    >>> x = 1e-3 * np.sin(2.0 * np.pi * t)
    >>> force = 5e4 * play(x, 2e-4)[0]  # a slider that gives way at 0.2 mm
    >>> found = identify_loops({"time_s": t, "displacement_m": x, "force_N": force}, normal_force=20.0)
    >>> mu, interval = friction_coefficient(found)
    >>> round(mu, 2), round(interval.high, 2)
    (0.5, 0.5)
    """
    if found.basis.normal_force is None:
        return math.nan, Interval(math.nan, math.nan)
    (N, error), F = found.basis.normal_force, found.answer.parameters[FRICTION]
    low, high = F.wider(F.value * error / N).interval
    return F.value / N, Interval(low / N, high / N)


def loop_history(found: Result[LoopBasis]) -> pd.DataFrame:
    """Return a table with a line for each cycle of measured loops; use it to see running-in, wear and heating.

    Columns are amplitude, energy lost, the friction force and contact stiffness of that cycle, mean force, equivalent
    viscous damping and stiffness, secant stiffness, damping ratio and the like, and the distance travelled so far.

    F_k of a cycle is (W − c ∮ ẋ² dt)/a, with c and the shape of the contact from all cycles. K_z follows from the
    residual in the cycle by one Gauss–Newton step in size and width of the contact. Both are NaN without a fit and for
    the first cycle of a record, as the state of the contact before it is unknown; the equivalent damping is NaN without
    times.

    >>> import numpy as np
    >>> from dampbalance import identify_loops, loop_history
    >>> from dampbalance.law.contact import play
    >>> t = np.linspace(0.0, 10.0, 4001)
    >>> x = 1e-3 * np.sin(2.0 * np.pi * t)
    >>> force = 5e4 * play(x, 2e-4)[0]  # a slider that gives way at 0.2 mm
    >>> found = identify_loops({"time_s": t, "displacement_m": x, "force_N": force})
    >>> loop_history(found)[["X_m", "W_J"]].median().round(4).to_dict()
    {'X_m': 0.001, 'W_J': 0.032}
    """
    import pandas as pd  # slow to import

    fit, c, tables = found.basis.fits.get(found.answer.name), loop_contact(found)["c"], []
    for number, loop in enumerate(found.basis.loops):
        b = loop.by_cycle(loop.v) if loop.timed else math.nan
        x, f = (of - loop.means(of)[loop.cycle] for of in (loop.x, loop.f))
        columns: dict[str, Any] = {
            "record": loop.name,
            "cycle": loop.first + np.arange(loop.cycles),
        }
        columns |= {"X_m": loop.amplitudes, "W_J": loop.lost, "F_k_N": math.nan}
        columns |= {"K_z_N_per_m": math.nan, "mean_force_N": loop.means(loop.f)}
        columns |= {"equivalent_damping_N_s_per_m": loop.lost / b}
        columns |= {"equivalent_stiffness_N_per_m": loop.means(f * x) / loop.means(x**2)}
        X = np.where(loop.closed, loop.amplitudes, math.nan)
        columns |= measures(X, loop.lost, loop.peaks)
        if fit:
            a, _, W = row_of(loop, fit)
            friction = (W - c * np.nan_to_num(b)) / np.where(a > 0.0, a / loop.load, np.nan)
            stiffness = fit.value("K_z") * _stiffer(fit, loop, number)
            for of in (friction, stiffness):
                of[: loop.cycles - loop.settled().cycles] = math.nan
            columns |= {"F_k_N": friction, "K_z_N_per_m": stiffness}
        if loop.N is not None:
            N = loop.means(loop.N)
            columns |= {"normal_force_N": N, "friction_coefficient": columns["F_k_N"] / N}
        tables.append(pd.DataFrame(columns).assign(travel_m=4.0 * np.cumsum(loop.amplitudes)))
    return pd.concat(tables, ignore_index=True)


@one_thread
def _stiffer(fit: LoopFit, loop: Loop, number: int) -> Array:
    """Return K_z of each cycle over that of all.   number : of the loop."""
    force = force_of(fit.contact, loop)
    # the force is proportional to K_z if the change of F_k at constant stiffness has a column of its own
    A = np.array([force, slope_of(fit.contact, loop), np.ones(force.size)])[:, loop.own].T
    left = fit.residual(loop, number)[loop.own]
    return np.array([1.0 + np.linalg.lstsq(A[own], left[own])[0][0] for own in loop.slices])


@with_options
def identify_loops(
    records: RecordLike | Sequence[RecordLike],
    stiffness: Stated | None = None,
    *,
    mapping: MappingLike = None,
    skip_cycles: int = 0,
    normal_force: Stated | None = None,
    fixture_stiffness: float | str | None = None,
    backlash: bool = True,
    **unknown: Never,
) -> Result[LoopBasis]:
    """Identify F_k, K_z and c of a contact on a test machine from loops of force against displacement.

    Use it for periodic motions of any shape: one record of five cycles or more, or several with different amplitudes
    and speeds. With fewer cycles, or if no contact fits, `levels` still has loss, secant stiffness, damping and
    backbone at each amplitude.

    records : as `read_records` takes or returns them, with a force and the displacement or velocity across the contact;
    without times, c is not determined.
    stiffness : leave it out, as loops have no oscillator; a spring in parallel to the contact is identified.
    mapping : the meaning of channels whose names do not give it, see `read_records`.
    The options of the signature, which `help` describes.

    If every record has a channel normal_force, the records share one μ, and F_k belongs to their mean normal force.

    Raises ValueError (for a record, `RecordError`) naming argument or record, what is wrong and the remedy: for a
    record without force or displacement, or without a complete cycle, and for a stiffness or a mass.

    >>> import numpy as np
    >>> from dampbalance import identify_loops
    >>> t = np.linspace(0.0, 10.0, 4001)
    >>> x, z = 1e-3 * np.sin(2.0 * np.pi * t), np.zeros(t.size)
    >>> for i in range(1, t.size):  # a slider that gives way at 0.2 mm
    ...     z[i] = np.clip(z[i - 1] + x[i] - x[i - 1], -2e-4, 2e-4)
    >>> found = identify_loops({"time_s": t, "displacement_m": x, "force_N": 5e4 * z})
    >>> round(found.values["F_k"], 3), round(found.values["K_z"], -2)
    (10.0, 50000.0)
    """
    read, of = read_request("loops", records, mapping, options_of(locals()))
    N, backlash = of["normal_force_N"], of["backlash"]
    normal = None if N is None else (N, of["normal_force_standard_error_N"])
    loops, measured, odd = read_loops(read, of["fixture_stiffness_N_per_m"], of["skip_cycles"])
    normal = normal or measured
    if flipped := [loop.name for loop in loops if loop.flipped]:
        odd.append(Finding("flipped", {"records": listed(flipped)}))
    weighed = _weighed(loops, backlash)
    fits = {name: one.fit for name, one in weighed.items()}
    answers = {name: _answer(name, one, loops) for name, one in weighed.items()}
    first = next(iter(fits.values()), None)
    found = Result(
        basis=LoopBasis(loops, fits, normal),
        k=math.nan,
        sources=tuple(record.name for record in read),
        estimates=answers or {"one slider": _unfitted(loops)},
        odd=tuple(odd),
        head=(
            f"{sum(loop.cycles for loop in loops)} cycles of {len(loops)} measured "
            f"loop{'s' * (len(loops) > 1)}; the answer first, with 95 % intervals"
        ),
        rig=[*_rig(first, loops, normal)] if first else [],
        check=[Finding(_COMPARED[name]) for name in [*fits][:1]],
        weighed=next(map(weighed_of, weighed.values()), ()),
        records=tuple(read),
        options=of,
    )
    found = with_stated_uncertainties(found)
    if normal is None or first is None:
        return found
    mu, (low, high) = friction_coefficient(found)
    of = {"mu": (mu, 0.5 * (high - low))}
    return replace(found, check=[*found.check, Finding("friction coefficient", of)])


def _weighed(loops: Sequence[Loop], backlash: bool) -> dict[str, Selection]:
    """Return the weighed contacts under the name of the heaviest, then the best fit of the other kind, one slider or
    many; nothing for too few cycles.

    Of long records, runs of cycles are fitted.
    """
    settled = [loop.settled() for loop in loops]
    cycles, samples = ([getattr(loop, of) for loop in settled] for of in ("cycles", "own"))
    if min(cycles) < 1 or sum(cycles) < FEWEST_CYCLES:
        return {}
    share = MOST_SAMPLES / sum(own.size for own in samples)
    runs = math.ceil(MOST_BLOCKS / len(loops))
    design = Design(settled if share >= 1.0 else [loop.excerpt(share, runs) for loop in settled])
    found = weigh(design, backlash=backlash)
    if "gradual" in found.names:
        return {"gradual": found, "one slider": select(found.plain, [], found.keys)}
    return {"one slider": found, "gradual": select(fit_gradual(found.fit.design), [], found.keys)}


def _unfitted(loops: Sequence[Loop]) -> Answer:
    """Return an answer without numbers, for too few cycles; its rows are those of a rigid contact."""
    parameters = dict.fromkeys((FRICTION, "c", "K_z"), UNKNOWN)
    X, W = (np.concatenate([getattr(of, n) for of in loops]) for n in ("amplitudes", "lost"))
    numbers = {"cycles": W.size, "many": W.size > 1, "least": FEWEST_CYCLES + len(loops)}
    note = Finding("few loops", numbers)
    names = tuple(loop.name for loop in loops for _ in range(loop.cycles))
    balance = Balance(Rows({FRICTION: 4.0 * X}, W), np.full(W.size, math.nan), names)
    return Answer("one slider", parameters, np.full((3, 3), math.nan), (note,), balance)


def row_of(loop: Loop, fit: LoopFit) -> tuple[Array, Array, Array]:
    """Return a, b and W of the balance of each cycle, m, m²/s and J, with the contact of a fit; the loss in a quadratic
    damper is subtracted from W."""
    quadratic = fit.parameters.by_key.get("c_2", 0.0) * loop.by_cycle(np.abs(loop.v) * loop.v)
    a = loop.by_cycle(force_of(fit.contact, loop)) / (fit.contact.F_k or 1.0)
    return a, loop.by_cycle(loop.v), loop.lost - quadratic


def _answer(name: str, weighed: Selection, loops: Sequence[Loop]) -> Answer:
    """Return the answer of the weighed contacts: numbers with intervals, and a row of the balance for each cycle."""
    from scipy.stats import t as student  # slow to import

    fit: LoopFit = weighed.fit
    notes, design = list[Finding](), fit.design
    # how far the choice of sliders matters: half as many, and without the softest or the stiffest
    fewer = (
        (SLIDERS // 2, WITHIN),
        (SLIDERS, (WITHIN[0], _SOFTEST)),
        (SLIDERS, (_STIFFEST, WITHIN[1])),
    )
    others = [fit_gradual(design, *of) for of in fewer if name == "gradual"]

    loads = [one.load / of.load for one, of in zip(fit.design.loops, loops, strict=True)]
    errors = np.sqrt(np.diag(weighed.covariance))
    numbers = dict(zip(weighed.keys, zip(weighed.values, errors, strict=True), strict=True))

    def estimate(symbol: str) -> ParameterEstimate:
        key = "rho" if symbol == "K_z" else symbol
        value, error = map(float, numbers[key])
        if not fit.slips or not (error > 0.0 and (value > 0.0 or symbol == "c")):
            return UNKNOWN
        off = max((abs(other.value(key) - value) for other in others), default=0.0)
        # the other choices bound it, as a rectangular distribution (GUM 4.3.7)
        reach = float(student.ppf(0.5 + 0.5 * CONFIDENCE, fit.freedom)) * error
        known = ParameterEstimate(value, error, Interval(value - reach, value + reach))
        known = known.wider(off / math.sqrt(3.0))
        if np.ptp(loads) and symbol == FRICTION:  # which would differ in a further record, too
            of_mean = float(np.std(loads, ddof=1)) / math.sqrt(len(loops))
            t = float(student.ppf(0.5 + 0.5 * CONFIDENCE, len(loops) - 1))
            known = known.wider(value * of_mean * t / NORMAL_95)
        if symbol == "c":
            return known if known.interval.high > 0.0 else UNKNOWN
        # K_z^{−1/2} rather has a normal distribution
        return stiffness_of(known) if symbol == "K_z" else known

    parameters = {s: estimate(s) for s in (FRICTION, "c", "K_z")}
    c, c_error = map(float, numbers["c"])
    shape = [*_other_shape(fit)]
    if not fit.slips:
        shape = shape or [Finding("loops stick")]
    elif not design.timed:
        # an ellipse of one size is that of a damper as well as of a contact that yields gradually
        sizes = len(levels_of(np.concatenate([loop.amplitudes for loop in loops])))
        alone = name == "gradual" and sizes == 1
        notes.append(Finding("no times", {"alone": alone}, {"": math.inf} if alone else {}))
    elif c < -CERTAIN * c_error:
        notes.append(Finding("negative damping", {"c": (c, c_error)}))
    elif not design.with_c:
        notes.append(Finding("one speed"))
    elif parameters["c"] is UNKNOWN:
        notes.append(Finding("c hidden"))
    notes += shape
    settled = [loop.settled() for loop in loops]
    rows = [row_of(loop, fit) for loop in settled]
    a, b, W = (np.concatenate(of) for of in zip(*rows, strict=True))
    names = tuple(loop.name for loop in settled for _ in range(loop.cycles))
    scatters = [np.full(of.size, np.std(of, ddof=min(1, of.size - 1))) for _, _, of in rows]
    terms = {FRICTION: a, "c": b} if design.timed else {FRICTION: a}
    balance = Balance(Rows(terms, W), np.concatenate(scatters), names)
    merit = {
        "residual": fit.rms / float(np.std(design.f)),
        "k_N_per_m": fit.value("k"),
        "k_standard_error_N_per_m": fit.error("k"),
    }
    if "g" in fit.parameters:
        merit |= {"gap_m": 2.0 * fit.value("g"), "gap_standard_error_m": 2.0 * fit.error("g")}
    symbols = [s for s, p in parameters.items() if p is not UNKNOWN]
    known = covariance_in(weighed, symbols, numbers["rho"][0])
    covariance = covariance_of(parameters, symbols, known)
    return Answer(name, parameters, covariance, tuple(notes), balance, merit=merit)


def _other_shape(fit: LoopFit) -> Iterator[Finding]:
    """Yield a finding where the contact does not describe the loops: by the residual relative to F_k, or to the force
    if nothing slips, and by the loss."""
    stuck = not fit.slips
    share = fit.beyond_noise / (float(np.std(fit.design.f)) if stuck else fit.value(FRICTION))
    loss = 0.0 if stuck else fit.wrong_loss
    if (off := max(share, loss)) > USELESS:
        numbers = {"share": share, "loss": loss, "wrong": loss > USELESS, "stuck": stuck}
        yield Finding("other shape", numbers, {"": off if off < _NO_SLIDER else math.inf})


_SAID_OF = {
    **{"k": "parallel spring", "n": "rounded knee", "F_S": "friction falls"},
    **{"v_0": "speed alone", "k_3": "hardening spring"},
    **{"c_2": "quadratic damper", "m": "mass between"},
}
"""Number of a fit → the finding that states it."""


def _rig(
    fit: LoopFit, loops: Sequence[Loop], normal: tuple[float, float] | None
) -> Iterator[Finding]:
    """Yield findings on fit, loads, spring, gap, and history of the cycles.   normal : mean normal force, N."""
    settled = [loop.settled() for loop in loops]
    fitted, total = (sum(loop.cycles for loop in some) for some in (fit.design.loops, settled))
    if fitted < total:
        yield Finding("excerpt", {"fitted": fitted, "all": total, "runs": MOST_BLOCKS})
    if np.ptp([loop.load for loop in fit.design.loops]) > DIFFER:
        forces = tuple((fit.value(FRICTION) * one.load, one.name) for one in fit.design.loops)
        N = normal[0] if normal and loops[0].N is not None else 0.0
        yield Finding("friction of each", {"forces": forces, "N": N})
    measured = {key: (fit.value(key), fit.error(key)) for key in fit.parameters.keys}
    for symbol, code in _SAID_OF.items():
        if symbol in measured:
            yield Finding(code, measured)
    if "g" in measured:
        yield Finding("backlash", {"gap": (2.0 * fit.value("g"), 2.0 * fit.error("g"))})
    for loop in loops:
        loop = loop.settled()
        W, cycles = loop.lost, np.arange(loop.cycles)
        level = np.abs(loop.amplitudes / np.median(loop.amplitudes) - 1.0) < SAME_LEVEL
        if level.sum() < loop.cycles or loop.cycles < 8:
            continue  # levels differ, or too few cycles for a trend
        half = W[loop.cycles // 2 :]
        scatter = 1.4826 * float(np.median(np.abs(half - np.median(half)))) or float(np.ptp(half))
        off = np.abs(W - np.median(half)) > _SETTLED * scatter
        start = int(np.flatnonzero(off[: loop.cycles // 2]).max(initial=-1)) + 1
        slope, covariance = np.polyfit(cycles, W / W.mean(), 1, cov=True)
        error = math.sqrt(covariance[0, 0])
        trend = (float(slope[0]), error) if abs(slope[0]) > CERTAIN * error else ()
        yield Finding(
            "steady loss", {"record": loop.name, "cycle": start + loop.first, "trend": trend}
        )
