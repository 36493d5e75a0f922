"""The contact and the damping from tables of steady responses to a stepped sine, line by line.

A line is a row of the balance, W = πFX sin φ, and its in-phase part says how stiff the contact still is at that
amplitude. Both are rows of the dynamic stiffness (`likelihood/dynamic_stiffness.py`), to which two contacts are fitted:
one slider, that of the paper, and many that slip one after the other, as the interface of a bolted joint does.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, Literal, get_args

import numpy as np

from ..arrays import Integers
from ..balance import Rows
from ..law.law import Law
from ..law.terms import FRICTION, term
from ..likelihood.dynamic_stiffness import (
    ContactComparison,
    ContactFit,
    SteppedLines,
    compare_contacts,
    fit_contact,
)
from ..project.wording import Remark, listed
from ..records.measured import MeasuredRecord
from .answer import UNKNOWN, Answer, Balance, Interval, ParameterEstimate, covariance_of
from .identified import Identified, Level, Picture
from .screen import with_error
from .sensitivities import Fault

Asked = Literal["both", "one slider", "gradual"]
"""Contacts that can be asked for."""


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class SteppedOutcome(Identified):
    """The answers to tables of steady responses, and all that they come from.

    lines : of all tables.   tables : index of the table that each belongs to, (n,).   fits : of each contact, by name,
    the one to use first.   scaled : whether all numbers follow the gains, none being held.
    """

    lines: SteppedLines
    tables: Integers
    fits: Mapping[str, ContactFit]
    scaled: bool

    kind: ClassVar[Mapping[str, str]] = {"kind": "stepped-sine"}
    mass_tests: ClassVar[bool] = False

    @property
    def fit(self) -> ContactFit:
        """That of the answer."""
        return self.fits[next(iter(self.answers))]

    @property
    def of_mode(self) -> SteppedLines:
        """The lines without what other modes add to them, by the fit of the answer."""
        return self.lines.of_mode(self.fit.values.get("R", 0.0))

    def findings(self) -> dict[str, Any]:
        """The sliders of each contact and how it predicts each level; the tables with their levels."""
        return {
            "contacts": {
                name: {
                    "r_m": fit.r,
                    "kappa_N_per_m": fit.kappa,
                    "held_out": {level: of._asdict() for level, of in fit.held_out.items()},
                }
                for name, fit in self.fits.items()
            },
            "records": [
                {"record": name, "lines": int(np.sum(self.tables == i))}
                for i, name in enumerate(self.sources)
            ],
        }

    def features_table(self) -> list[dict[str, Any]]:
        """A row for each line: what was measured, its input work and its dynamic stiffness."""
        of, W = self.lines, math.pi * self.lines.X**2 * self.lines.Z.imag
        return [
            {
                "record": self.sources[self.tables[i]],
                "level": of.names[of.level[i]],
                "frequency_Hz": of.omega[i] / (2.0 * math.pi),
                "force_N": of.X[i] * abs(of.Z[i]),
                "X_m": of.X[i],
                "phi_rad": np.angle(of.Z[i]),
                "W_J": W[i],
                "in_phase_stiffness_N_per_m": of.Z[i].real,
            }
            for i in range(of.X.size)
        ]

    @property
    def levels(self) -> list[Level]:
        """The line of each level whose phase is nearest to 90°."""
        of, levels = self.of_mode, []
        W, friction = math.pi * of.X**2 * of.Z.imag, self.fit.sliders.loss(of.X)
        for number, name in enumerate(of.names):
            (own,) = np.nonzero(of.level == number)
            at = own[np.argmax(np.sin(np.angle(of.Z[own])))]
            X, omega = float(of.X[at]), float(of.omega[at])
            levels.append(Level(name, X, omega, float(W[at]), float(friction[at])))
        return levels

    def shifts(
        self, faults: Mapping[str, Fault], names: Collection[str]
    ) -> dict[str, dict[str, dict[str, float]]]:
        """What gains do to the answers, where all numbers are free to follow: forces go with that of the drive, motions
        with that of the response, and an exact law of scales says how each number does. With k or m held there is no
        such law, except for the stiffness of a table of base motions, which scales all forces."""

        def shift(symbol: str, fault: Fault) -> float:
            order = 1.0 if symbol in ("K_z", "m") else term(symbol).order
            if not self.scaled:
                return fault.stiffness
            return fault.drive - order * fault.response

        return {
            name: {
                fault: {symbol: shift(symbol, of) for symbol in answer.parameters}
                for fault, of in faults.items()
            }
            for name, answer in self.answers.items()
            if name in names
        }

    @property
    def pictures(self) -> dict[str, Picture]:
        """loss : energy lost per cycle over the amplitude.   stiffness : the in-phase stiffness over it.   distribution
        : of the sliders."""
        of, fits = self.of_mode, {name: self.fits[name] for name in self.answers}
        count = f"{of.X.size} lines at {len(of.names)} levels"
        return {
            "loss": Picture(
                f"energy lost per cycle against amplitude: {count}, and the laws with their bands",
                (of, fits),
            ),
            "stiffness": Picture(
                f"stiffness against amplitude: {count}, and the laws with their bands", (of, fits)
            ),
            "distribution": Picture(
                "stiffness of the sliders against the amplitude at which each begins to slip",
                (fits,),
            ),
        }


def identify_tables(
    tables: Sequence[MeasuredRecord],
    k: float | None,
    law: Law,
    *,
    contact: Asked = "both",
    mass: float | None = None,
    hardening: bool = True,
    residual: bool = False,
    replicates: int,
    seed: int,
) -> SteppedOutcome:
    """The contact and the damping from tables of steady responses at two levels of excitation or more.

    k : stiffness, N/m; None where the lines are to tell it, which those of base motions cannot.   law : whose terms
    except the friction are fitted.   Others as for `identify`.

    Raises ValueError for base motions without a stiffness, fewer than two levels, lines that do not determine the
    unknowns, and a friction force that is given.
    """
    lines, of_tables = _lines(tables, k)
    if FRICTION in law.given:
        raise ValueError(
            f"{FRICTION} cannot be given for a stepped sine: it is what slips in the amplitudes seen"
        )
    terms = tuple(symbol for symbol in law.terms if symbol != FRICTION)
    asked: dict[str, Any] = {
        **{"terms": terms, "given": dict(law.given), "stiffness": k, "mass": mass},
        **{"hardening": hardening, "residual": residual, "replicates": replicates, "seed": seed},
    }
    found, fits = None, {}
    if contact == "both":
        found = compare_contacts(lines, **asked)
        order = sorted(get_args(Asked)[1:], key=lambda name: name != found.supported)
        fits = {name: found.fits[name] for name in order}
    else:
        fits = {contact: fit_contact(lines, contact=contact, **asked)}
    answers = {name: _answer(name, fit, lines, law, found) for name, fit in fits.items()}
    values = next(iter(fits.values())).values
    held = f"{lines.X.size} lines at {len(lines.names)} levels"
    return SteppedOutcome(
        k=values["k"],
        sources=tuple(table.name for table in tables),
        estimates=answers,
        reference=None,
        warnings=(),
        head=f"{held}; the answer first, with 95 % intervals from {replicates} replicates",
        rig=[
            *_rig(next(iter(fits.values())), lines),
            *_counted(tables),
            *([found.sentence] if found else []),
        ],
        settings={
            "law": {"terms": law.terms, "given": law.given},
            "replicates": replicates,
            "seed": seed,
        },
        lines=lines,
        tables=of_tables,
        fits=fits,
        scaled=k is None and mass is None and not law.given,
    )


def _lines(tables: Sequence[MeasuredRecord], k: float | None) -> tuple[SteppedLines, Integers]:
    """All lines of the tables, and the table of each."""
    levels, owners, names = [], [], []
    for number, table in enumerate(tables):
        assert table.table is not None
        if k is None and not table.table.by_force:
            raise ValueError(
                f"{table.name}: the base drives, and what it puts in is known with the stiffness of the spring to it "
                "only: give stiffness (--stiffness)"
            )
        for level in table.table.levels:
            force = level.drive if table.table.by_force else (k or 0.0) * level.drive
            levels.append((level, force / level.X * np.exp(1j * level.phi)))
            owners += [number] * level.X.size
            names.append(level.name)
    if len(levels) < 2:
        raise ValueError(
            f"{tables[0].name} holds one level of excitation: what a contact does shows between amplitudes; give "
            "tables of two levels or more, or name the column of levels"
        )
    if len({*names}) < len(names):
        several = [len(t.table.levels) for t in tables if t.table is not None]
        owner = np.repeat([table.label for table in tables], several)
        names = [f"{one}: {name}" for one, name in zip(owner, names, strict=True)]
    errors = [level.error for level, _ in levels if level.error is not None]
    return SteppedLines(
        np.concatenate([level.omega for level, _ in levels]),
        np.concatenate([level.X for level, _ in levels]),
        np.concatenate([Z for _, Z in levels]),
        np.repeat(np.arange(len(levels)), [level.X.size for level, _ in levels]),
        tuple(names),
        np.concatenate(errors) if len(errors) == len(levels) else None,
    ), np.array(owners)


def _answer(
    name: str, fit: ContactFit, lines: SteppedLines, law: Law, found: ContactComparison | None
) -> Answer:
    """The answer of a contact: its numbers, and its rows of the balance, without what other modes add to them."""
    notes, of = [], lines.of_mode(fit.values.get("R", 0.0))
    if found is not None and name != found.supported:
        notes.append(Remark(f"another contact describes these lines better: {found.sentence}"))
    parameters = {symbol: _estimate(symbol, fit) for symbol in (*law.unknowns, "K_z")}
    X, W = of.X, math.pi * of.X**2 * of.Z.imag
    terms = {FRICTION: fit.sliders.loss(X) / (fit.F_k or math.nan)}
    for symbol in fit.terms:
        terms[symbol] = term(symbol).harmonic(of.omega, X, 0.0, 0.0, fit.values["k"])
    rows = Rows(terms, W, given=law.given)
    left = fit.residuals.imag
    balance = Balance(
        rows,
        fit.misfit.loss * W,
        tuple(lines.names[i] for i in lines.level),
        {"frequency_Hz": (lines.omega / (2.0 * math.pi)).tolist()},
    )
    keys = {"k": "k_N_per_m", "m": "m_kg", "k_3": "k_3_N_per_m3", "R": "R_m_per_N"}
    merit: dict[str, Any] = {
        "residual": float(np.linalg.norm(left * W) / np.linalg.norm(W)),
        "misfit": fit.misfit.score,
        "loss_rms": fit.misfit.loss,
        "in_phase_rms_N_per_m": fit.misfit.in_phase,
        "smoothness_chosen_by": fit.chosen_by,
    }
    for symbol, key in keys.items():
        if symbol in fit.values:
            merit |= {key: fit.values[symbol]}
            head, _, unit = key.partition("_") if symbol != "k_3" else ("k_3", "", "N_per_m3")
            merit |= {f"{head}_standard_error_{unit}": fit.errors.get(symbol, 0.0)}
    return Answer(
        name, parameters, covariance_of(parameters, {}), tuple(notes), balance, merit=merit
    )


def _estimate(symbol: str, fit: ContactFit) -> ParameterEstimate:
    """A number of a fit: F_k and K_z of the sliders that slip at the amplitudes seen, or a coefficient."""
    if symbol not in fit.intervals:
        return UNKNOWN
    of_contact = {"K_z": fit.K_z, FRICTION: fit.F_k}
    value = of_contact.get(symbol, fit.values.get(symbol, math.nan))
    interval, doubt = Interval(*fit.intervals[symbol]), ""
    if symbol == "K_z" and fit.lower_limit:
        return ParameterEstimate(math.inf, math.nan, math.nan, Interval(interval.low, math.inf))
    if value == 0.0:
        doubt = f"these lines show no {term(symbol).words} next to the contact: {symbol} is at its bound, zero"
    return ParameterEstimate(value, fit.errors[symbol], math.nan, interval, doubt)


def _rig(fit: ContactFit, lines: SteppedLines) -> Iterator[str]:
    """What the fit implies about the rig, in sentences."""
    k, m = fit.values["k"], fit.values["m"]
    own = {
        s: with_error(fit.values[s], fit.errors[s]) if s in fit.errors else "" for s in fit.values
    }
    yield (
        f"The oscillator has m = {own['m'] or format(m, 'g')} kg, k = {own['k'] or format(k, 'g')} N/m with all of the "
        f"contact that yields slipping, and then a natural frequency of {math.sqrt(k / m) / (2.0 * math.pi):.4g} Hz."
    )
    if fit.values.get("k_3"):
        yield f"Its spring stiffens: k_3 = {own['k_3']} N/m³."
    if R := fit.values.get("R"):
        omega = float(np.median(lines.omega))
        like = (
            "their flexibility"
            if R > 0.0
            else f"the inertia of {1.0 / (-R * omega**2):.2g} kg that moves in them"
        )
        yield f"Other modes add R = {1e6 * R:.3g} µm/N to what the driven point answers: {like}."


def _counted(tables: Sequence[MeasuredRecord]) -> list[str]:
    """How the phases of the tables are counted, a sentence for each way."""
    ways: dict[str, list[str]] = {}
    for table in tables:
        assert table.table is not None
        ways.setdefault(table.table.convention, []).append(table.label)
    return [f"{listed(of)}: {way}, as its lines show." for way, of in ways.items()]
