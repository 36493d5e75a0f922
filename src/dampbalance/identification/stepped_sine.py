"""The contact and the damping from tables of steady responses to a stepped sine, line by line.

A line is a row of the balance, W = πFX sin φ, and its in-phase part says how stiff the contact still is at that
amplitude. Both are rows of the dynamic stiffness (`fit/stiffness_lines.py`), to which two contacts are fitted:
one slider, that of the paper, and many that slip one after the other, as the interface of a bolted joint does.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, Any, ClassVar, Literal, Never

import numpy as np

from ..arrays import Integers
from ..balance import Rows
from ..findings.finding import UNBOUNDED, Finding
from ..findings.words import sentence
from ..fit.contacts import ContactComparison, ContactFit, compare_contacts, fit_contact
from ..fit.select import CLEAR, select
from ..fit.stiffness_lines import Contact, StiffnessLines
from ..law.law import Law, law_of
from ..law.terms import FRICTION, term
from ..project.options import Stated, options_of, with_options
from ..project.spelling import spelled
from ..project.wording import listed
from ..records.mapping import MappingLike
from ..records.stepped_sine import SteppedRecord, read_lines
from ..signals.thresholds import CERTAIN
from .answer import (
    UNKNOWN,
    Answer,
    Balance,
    Interval,
    ParameterEstimate,
    averaged,
    covariance_of,
    rig_of,
)
from .level import Column, Level
from .request import read_request
from .result import Picture, Result
from .sensitivities import Fault
from .stated import with_stated_uncertainties
from .weighing import weighed_of

if TYPE_CHECKING:
    import pandas as pd
    from numpy.typing import ArrayLike

    from ..records.measured import RecordLike

_FELT = 0.01  # of k: stiffness of the sticking part of the contact from which on it is reported
_CONTACTS: tuple[Contact, ...] = ("one slider", "gradual")
_WORDS = {"none": "no contact", "gradual": "a contact that yields gradually"}


@dataclass(frozen=True, eq=False, repr=False)
class SteppedBasis:
    """The data and fits behind the answers to tables of a stepped sine.

    lines : of all tables.
    table_of : index of the table of each line, (n,).
    fits : of each contact, by name, the one to use first.
    compared : which contact the lines support; None with fewer than three levels.
    """

    lines: StiffnessLines
    table_of: Integers
    fits: Mapping[str, ContactFit]
    compared: ContactComparison | None

    kind: ClassVar[str] = "stepped-sine"
    mass_tests: ClassVar[bool] = False
    columns: ClassVar[Mapping[str, Column]] = {}

    def document(self, found: Result[Any]) -> dict[str, Any]:
        """Return the entries of the document for a stepped sine: the supported contact, the sliders, the tables."""
        compared: dict[str, Any] = {}
        if (of := self.compared) is not None:
            compared = {
                "supported": of.supported,
                "words": sentence(_supported(of), found.coordinate),
            }
        sliders = {name: fit.all_sliders for name, fit in self.fits.items()}
        return {
            "comparison": compared,
            "contacts": {
                name: {"r_m": of.r, "kappa_N_per_m": of.kappa} for name, of in sliders.items()
            },
            "records": [
                {"record": name, "lines": int(np.sum(self.table_of == i))}
                for i, name in enumerate(found.sources)
            ],
        }

    def levels(self, found: Result[Any]) -> list[Level]:
        """Return the line of each level whose phase is nearest to 90°."""
        fit, levels = self.fits[found.answer.name], []
        of = _of_mode(self.lines, fit)
        W, friction = math.pi * of.X**2 * of.Z.imag, fit.sliders.loss(of.X)
        for level, name in enumerate(of.names):
            (own,) = np.nonzero(of.level == level)
            at = own[np.argmax(np.sin(np.angle(of.Z[own])))]
            X, omega = float(of.X[at]), float(of.omega[at])
            levels.append(Level(name, X, omega, float(W[at]), float(friction[at])))
        return levels

    def with_fault(self, found: Result[Any], name: str, fault: Fault) -> dict[str, float]:
        """Return the numbers of an answer from lines with a fault; stated numbers are held. The force of a base that
        moves is proportional to the stiffness."""
        fit, of = self.fits[name], self.lines
        lag, k, X = fault.late * of.omega + fault.angle, 1.0 + fault.stiffness, 1.0 + fault.response
        by_force = np.array(["force" in table.quantities for table in found.records])[self.table_of]
        force = (1.0 + fault.drive) * np.where(by_force, 1.0, k)
        other = replace(of, X=X * of.X, Z=of.Z * force / X * np.exp(1j * lag))
        known = {"k": k, "m": 1.0 + fault.mass}
        given = {s: p * fit.value(s) for s, p in known.items() if not fit.parameters[s].free}
        again = fit.again(other, **given)
        symbols = (*found.estimates[name].parameters, "m")
        return {s: again.value(s) for s in symbols if s in again.slopes}

    def pictures(self, found: Result[Any]) -> dict[str, Picture]:
        """Return the energy lost per cycle and the in-phase stiffness over the amplitude, and the sliders."""
        from . import stepped_pictures as drawn  # slow to import

        fits = {name: self.fits[name] for name in found.approaches}
        of = _of_mode(self.lines, fits[found.answer.name])
        return {
            "loss": Picture(drawn.loss, (of, fits)),
            "stiffness": Picture(drawn.stiffness, (of, fits)),
            "distribution": Picture(drawn.distribution, (fits,)),
        }


def damping_at(found: Result[SteppedBasis], X: ArrayLike, frequency_hz: ArrayLike) -> pd.DataFrame:
    """Return the equivalent damping ratio at given amplitudes, as identified from a stepped sine, with its interval.

        ζ(X) = W(X)/(2π m ω² X²)

    W(X) is the energy that the identified contact and damping lose in a cycle. Use the ratio to predict a decay, or in
    a linear model of the structure at a known amplitude. The table has the columns X_m, damping_ratio, low and high
    (95 % interval), which are NaN outside of the measured amplitudes.

    found : result of `identify_joint`.   X : amplitudes, m, (n,).   frequency_hz : frequency of the motion, Hz, (n,) or
    a single one.

    >>> import math
    >>> import numpy as np
    >>> from dampbalance import Oscillator, damping_at, identify_joint, steady_orbits
    >>> osc = Oscillator(m=2.42, c=9.0, k=2310.0, K_z=2310.0, F_k=1.28)
    >>> hertz, Y = np.linspace(4.0, 8.0, 17), np.array([[2e-4], [5e-4], [1e-3]])
    >>> orbits = steady_orbits(osc, Y=Y, omega=2 * math.pi * hertz)
    >>> table = {
    ...     "frequency_hz": orbits.given["omega"].ravel() / (2 * math.pi),
    ...     "base_displacement_m": orbits.given["Y"].ravel(),
    ...     "displacement_m": orbits.X_1.ravel(),
    ...     "phase_rad": -orbits.phi_1.ravel(),
    ...     "level": orbits.given["Y"].ravel(),
    ... }
    >>> found = identify_joint(table, stiffness=2310.0, contact="one slider", hardening=False)
    >>> damping_at(found, [0.0005, 0.001, 0.01], 5.0)["damping_ratio"].round(3).tolist()
    [0.059, 0.211, nan]
    """
    import pandas as pd  # slow to import

    fit = found.basis.fits[found.answer.name]
    X, frequency_hz = np.broadcast_arrays(np.atleast_1d(X).astype(float), frequency_hz)
    omega, (low, high) = 2.0 * math.pi * frequency_hz, fit.X_range
    measured = (low <= X) & (high >= X)
    ratios = np.full((3, X.size), math.nan)
    if measured.any():
        Z, reach = fit.law(X[measured], omega[measured])
        size = 2.0 * fit.value("m") * omega[measured] ** 2
        ratios[:, measured] = np.array([Z, Z - reach, Z + reach]).imag / size
    columns = dict(zip(("damping_ratio", "low", "high"), ratios, strict=True))
    return pd.DataFrame({"X_m": X, **columns})


@with_options
def identify_joint(
    records: RecordLike | Sequence[RecordLike],
    stiffness: Stated | None = None,
    *,
    mapping: MappingLike = None,
    mass: Stated | None = None,
    terms: Sequence[str] | str | None = None,
    given: Mapping[str, float] | None = None,
    contact: Literal["both", "one slider", "gradual"] = "both",
    hardening: bool = True,
    residual: bool = False,
    **unknown: Never,
) -> Result[SteppedBasis]:
    """Identify the contact and the damping of a joint from tables of a stepped sine.

    Use it for the frequency responses of a bolted joint, a damper or a blade root near a resonance, measured at several
    levels of excitation. Each line of a table is a steady response with its frequency, amplitudes and phase. Two levels
    are needed, and three to find out whether one slider is enough.

    records : as `read_records` takes or returns them, one table or several.
    stiffness : k of the spring, N/m, as for `identify_forced`; needed only if a base drives, not a force.
    mapping : the meaning of columns whose names do not give it, see `read_records`.
    The options of the signature, which `help` describes.

    Raises ValueError (for a record, `RecordError`) naming argument or record, what is wrong and the remedy: for an
    argument outside its range, other records than such tables, fewer than two levels, and lines that do not determine
    the unknowns.

    >>> import math
    >>> import numpy as np
    >>> from dampbalance import Oscillator, identify_joint, steady_orbits
    >>> osc = Oscillator(m=2.42, c=9.0, k=2310.0, K_z=2310.0, F_k=1.28)
    >>> hertz, Y = np.linspace(4.0, 8.0, 17), np.array([[2e-4], [5e-4], [1e-3]])
    >>> orbits = steady_orbits(osc, Y=Y, omega=2 * math.pi * hertz)
    >>> table = {
    ...     "frequency_hz": orbits.given["omega"].ravel() / (2 * math.pi),
    ...     "base_displacement_m": orbits.given["Y"].ravel(),
    ...     "displacement_m": orbits.X_1.ravel(),
    ...     "phase_rad": -orbits.phi_1.ravel(),
    ...     "level": orbits.given["Y"].ravel(),
    ... }
    >>> found = identify_joint(table, stiffness=2310.0, contact="one slider", hardening=False)
    >>> {symbol: f"{value:.3g}" for symbol, value in found.values.items()}
    {'F_k': '1.29', 'c': '9', 'K_z': '2.31e+03'}
    """
    options, reader = options_of(locals()), partial(read_lines, stated=True)
    read, of = read_request("stepped-sine", records, mapping, options, reader)
    law, contact = law_of(of["terms"], of["given"], None), of["contact"]
    tables = [record for record in read if isinstance(record, SteppedRecord)]
    if FRICTION in law.given:
        raise ValueError(
            f"{FRICTION} depends on the amplitudes of a stepped sine, and cannot be given: leave it out"
        )
    k = of["stiffness_N_per_m"]
    lines, table_of = _lines(tables, k)
    asked: dict[str, Any] = {
        "terms": tuple(symbol for symbol in law.terms if symbol != FRICTION),
        "given": dict(law.given),
        "stiffness": k,
        "mass": of["mass_kg"],
        "hardening": of["hardening"],
        "residual": of["residual"],
    }
    contacts, compared = _CONTACTS if contact == "both" else (contact,), None
    if contact == "both" and len(lines.names) > 2:
        compared = compare_contacts(lines, **asked)
        own = dict.fromkeys([compared.supported, *contacts])
        fits = {name: compared.fits[name] for name in own}
    else:
        fits = {name: fit_contact(lines, contact=name, **asked) for name in contacts}
    first = next(iter(fits.values()))
    # of tables that a base drives, the stiffness scales the force
    tested = all(of.by_force for of in tables)
    k_error = of["stiffness_standard_error_N_per_m"] or 0.0 if tested else math.inf
    check, *implied = [*([_supported(compared)] if compared else []), *_rig(first, lines)]
    unbounded = {FRICTION: math.inf, "K_z": math.inf}
    unsure = compared is None and len(contacts) > 1
    uncompared = [Finding("two levels", effect=unbounded)] if unsure else []
    found = Result(
        basis=SteppedBasis(lines, table_of, fits, compared),
        k=first.value("k"),
        sources=tuple(table.name for table in tables),
        estimates={
            name: _answer(name, fit, lines, law, compared, k_error) for name, fit in fits.items()
        },
        odd=(*uncompared, *_on_stuck(first)),
        head=f"{lines.X.size} lines at {len(lines.names)} levels; the answer first, with 95 % intervals",
        rig=[*implied, *_counted(tables)],
        check=[check],
        weighed=() if compared is None else weighed_of(compared.selection, "one slider"),
        settings={"law": {"terms": law.terms, "given": law.given}},
        records=tuple(tables),
        options=of,
    )
    return with_stated_uncertainties(found)


def _lines(tables: Sequence[SteppedRecord], k: float | None) -> tuple[StiffnessLines, Integers]:
    """Return all lines of the tables, and the table of each."""
    levels = [(i, one.by_force, of) for i, one in enumerate(tables) for of in one.levels]
    by_base = next((tables[i].name for i, by_force, _ in levels if not by_force), None)
    if by_base and k is None:
        raise ValueError(
            f"{by_base}: the base drives, and its force follows only from the stiffness of the spring to it: give "
            f"{spelled('stiffness')}"
        )
    if len(levels) < 2:
        raise ValueError(
            f"{tables[0].name} has one level of excitation, and a contact shows only between amplitudes; give "
            "tables of two levels or more, or name the column of levels"
        )
    names = [of.name for _, _, of in levels]
    if len({*names}) < len(names):
        names = [f"{tables[i].label}: {of.name}" for i, _, of in levels]
    sizes = [of.X.size for _, _, of in levels]
    forces = [of.drive * (1.0 if by_force else k or 0.0) for _, by_force, of in levels]
    omega, X, phi = (
        np.concatenate([getattr(of, n) for _, _, of in levels]) for n in ("omega", "X", "phi")
    )
    errors = [of.error for _, _, of in levels if of.error is not None]
    error = np.concatenate(errors) if len(errors) == len(levels) else None
    Z = np.concatenate(forces) / X * np.exp(1j * phi)
    numbers = np.repeat(np.arange(len(levels)), sizes)
    lines = StiffnessLines(omega, X, Z, numbers, tuple(names), error)
    return lines, np.repeat([i for i, _, _ in levels], sizes)


def _on_stiffness(fit: ContactFit, stiffness_error: float) -> Iterator[Finding]:
    """Yield a finding where the lines contradict the stiffness stated, by the likelihood of the contact with k free."""
    if math.isinf(stiffness_error) or fit.shown is None:
        return
    k, (shown, gain) = fit.value("k"), fit.shown
    error = abs(k - shown) / math.sqrt(gain) if gain > 0.0 else math.inf
    if abs(k - shown) > CERTAIN * math.hypot(error, stiffness_error):
        of = {"k": k, "shown": (shown, error), "soft": bool(k < shown)}
        yield Finding("stiffness differs", of, UNBOUNDED)


def _on_stuck(fit: ContactFit) -> Iterator[Finding]:
    """Yield a finding where a contact that sticks in every line makes up for a stiffness stated too small."""
    k = fit.value("k")
    if fit.stuck > _FELT * k:
        of = {"k": k, "shown": k + fit.stuck, "stuck": fit.stuck}
        yield Finding("sticks in every line", of)


def _answer(
    name: str,
    fit: ContactFit,
    lines: StiffnessLines,
    law: Law,
    compared: ContactComparison | None,
    k_error: float,
) -> Answer:
    """Return the answer of a contact: its numbers, and the rows of the balance without the part of other modes."""
    notes, of = [*_on_stiffness(fit, k_error)], _of_mode(lines, fit)
    if compared is not None and name != compared.supported:
        notes.append(Finding("another contact", {"contact": compared.supported}, UNBOUNDED))
    elif compared is None and fit.noise > 1.0:
        notes.append(Finding("levels depart", effect=UNBOUNDED))
    elif fit.problem.contact == "none":
        notes.append(Finding("no contact", {"why": _supported(compared)} if compared else {}))
    X, W, sliders = of.X, math.pi * of.X**2 * of.Z.imag, fit.sliders
    terms = {FRICTION: sliders.loss(X) / sliders.F_k} if sliders.F_k else {}
    terms |= {s: term(s).harmonic(of.omega, X, 0.0, 0.0, fit.value("k")) for s in fit.terms}
    rows = Rows(terms, W, given=law.given)
    hertz = (lines.omega / (2.0 * math.pi)).tolist()
    names = tuple(lines.names[i] for i in lines.level)
    unknowns = dict.fromkeys([*law.unknowns, *(s for s in fit.terms if s not in law.given), "K_z"])
    parameters = {symbol: _estimate(symbol, fit) for symbol in unknowns}
    misfit = fit.problem.misfit(fit.point)
    left = rows.misfit({symbol: fit.value(symbol) for symbol in terms})
    merit: dict[str, Any] = {
        "residual": float(np.linalg.norm(left) / np.linalg.norm(W)),
        "misfit": misfit.score,
        "loss_rms": misfit.loss,
        "in_phase_rms_N_per_m": misfit.in_phase,
    }
    for symbol, unit in _SPRING_UNITS.items():
        if symbol in fit.parameters:
            merit[f"{symbol}_{unit}"] = fit.value(symbol)
            merit[f"{symbol}_standard_error_{unit}"] = fit.error(symbol)
    bounded = [s for s, p in parameters.items() if math.isfinite(p.standard_error)]
    covariance = covariance_of(parameters, bounded, fit.covariance_of(*bounded))
    balance = Balance(rows, misfit.loss * W, names, {"frequency_Hz": hertz})
    answer = Answer(name, parameters, covariance, tuple(notes), balance, merit=merit)
    if compared is not None and name == compared.supported:
        answer = averaged(answer, compared.selection)
    of_rig = [key for key in ("c", "m", "k") if key in fit.slopes]
    rig = rig_of(select(fit, (), of_rig, noise=1.0))
    # none of them is negative
    parameters = {
        s: replace(p, interval=Interval(max(p.interval.low, 0.0), p.interval.high))
        for s, p in answer.parameters.items()
    }
    return replace(answer, parameters=parameters, rig=rig)


_SPRING_UNITS = {"k": "N_per_m", "m": "kg", "k_3": "N_per_m3", "R": "m_per_N"}


def _of_mode(lines: StiffnessLines, fit: ContactFit) -> StiffnessLines:
    """Return the lines without the part of other modes, according to a fit."""
    return lines.of_mode(fit.value("R") if "R" in fit.parameters else 0.0)


def _estimate(symbol: str, fit: ContactFit) -> ParameterEstimate:
    """Return a number of a fit: F_k and K_z of the sliders that slip at the amplitudes seen, or a coefficient."""
    if symbol not in fit.slopes:
        return UNKNOWN
    interval = Interval(*fit.interval(symbol))
    if math.isinf(interval.high):
        return ParameterEstimate(math.inf, math.nan, interval)
    return ParameterEstimate(fit.value(symbol), fit.error(symbol), interval)


def _supported(compared: ContactComparison) -> Finding:
    """Return a finding on the contact that the lines support, by its weight."""
    name, fit = compared.supported, compared.fits[compared.supported]
    left = fit.problem.misfit(fit.point)
    others = (n for n, weight in compared.weights.items() if n != name and weight > 1.0 - CLEAR)
    of = {"loss": left.loss, "stiffness": left.in_phase, "weight": compared.weights[name]}
    of |= {"contact": _WORDS.get(fit.problem.contact, "one slider"), "terms": fit.terms}
    return Finding("contact", of | {"others": tuple(others)})


def _rig(fit: ContactFit, lines: StiffnessLines) -> Iterator[Finding]:
    """Yield findings on the rig that the fit implies."""
    own = {s: (fit.value(s), fit.error(s)) for s in _SPRING_UNITS if s in fit.parameters}
    k, _, k_3, R = (own.get(s, (0.0, 0.0)) for s in _SPRING_UNITS)
    if fit.sliders.F_k:
        yield Finding("part that slips", {"X": float(fit.X_range[1])})
    if k[1]:
        yield Finding("spring of lines", {"k": k})
    if k_3[0]:
        yield Finding("hardens", {"k_3": k_3})
    if R[0]:
        mass = 1.0 / (abs(R[0]) * float(np.median(lines.omega)) ** 2)
        yield Finding("other modes", {"R": R[0], "mass": mass if R[0] < 0.0 else 0.0})


def _counted(tables: Sequence[SteppedRecord]) -> list[Finding]:
    """Return a finding for each way in which the tables count their phases."""
    ways: dict[str, list[str]] = {}
    for table in tables:
        ways.setdefault(table.convention, []).append(table.label)
    return [Finding("phases", {"tables": listed(of), "way": way}) for way, of in ways.items()]
