"""Contact, damping, stiffness and mass from steady responses to a harmonic force, with intervals; which contact it is.

The equations and the fit are those of `stiffness_lines.py`. Intervals come from replicates of the lines about the law.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

import numpy as np

from ..arrays import Array, Complexes
from ..findings.finding import Finding
from ..law.contact import Sliders, secant
from ..signals.one_thread import one_thread
from .goodness import as_good
from .stiffness_lines import (
    LESS,
    Contact,
    ContactEstimate,
    Design,
    Misfit,
    SteppedLines,
    StiffnessRows,
    estimated,
    stiffness_part,
)

_REPEATS = 3  # of the errors of changed lines, which start from those of the fit
_FIRST_ERROR = 0.05  # of Z, where the iteration of errors starts
_ALIKE = 1.05  # of amplitudes: closer ones count as one
_SINGULAR = 1e-7  # smallest singular value of columns of length one
_DRAWS = 200  # of intervals, which know a standard error to 5 %, in a tenth of a second
_SEED = 2010  # of these, so that the same lines give the same bytes
_NORMAL, _CHI_SQUARE = 1.96, 3.84  # of intervals of 95 %
_COMPARED = 3  # levels, at least
_WORDS = {
    "none": "no contact",
    "one slider": "one slider",
    "gradual": "a contact that yields gradually",
}
_FALSE_ALARMS = 0.05  # of a gradual contact where one slider is the truth


class Band(NamedTuple):
    """A value and its interval of 95 %, each an array: loss per cycle in J, or stiffness in N/m."""

    value: Array
    low: Array
    high: Array


class _Draws(NamedTuple):
    """The law that replicates are drawn about, and these: linear unknowns by name, (1 + B,), sliders, (1 + B, j)."""

    linear: Mapping[str, Array]
    r: Array
    kappa: Array


@dataclass(frozen=True, eq=False)
class ContactFit:
    """A contact and an oscillator identified from stepped lines.

    contact, terms : of the law.
    values : k, m, k_3, R and the coefficients of the terms, SI units, the given ones too.
    r, kappa : sliders, m and N/m, (j,).
    errors, intervals : standard errors and intervals of 95 % of what is not given, of F_k and K_z, and of the r of one
    slider. The upper end of K_z is infinite where the amplitudes are so large that lines tell only a lower limit.
    residuals : (loss of the law)/W − 1, (n,).   misfit : root mean squares.
    X_range : amplitudes that were seen, m.
    smoothing : weight of the smoothness of κ.
    shown : where k is given, that of the lines if it is free and the χ² that it saves.
    replicates : by name, about the law first, (1 + B,).
    """

    contact: Contact
    terms: tuple[str, ...]
    values: Mapping[str, float]
    r: Array
    kappa: Array
    errors: Mapping[str, float]
    intervals: Mapping[str, tuple[float, float]]
    residuals: Array
    misfit: Misfit
    X_range: tuple[float, float]
    smoothing: float
    shown: tuple[float, float] | None
    design: Design = field(repr=False)
    draws: _Draws = field(repr=False)
    replicates: Mapping[str, Array] = field(repr=False)

    @property
    def sliders(self) -> Sliders:
        """Those that slip at the amplitudes seen."""
        slips = self.r < self.X_range[1]
        return Sliders(self.r[slips], self.kappa[slips])

    @property
    def stuck(self) -> float:
        """Stiffness of the contact that slips at none of the amplitudes seen, N/m; 0 unless k is given."""
        return float(np.sum(self.kappa)) - self.K_z

    @property
    def K_z(self) -> float:
        """Stiffness of the contact that yields at the amplitudes seen, N/m."""
        return self.sliders.K_z

    @property
    def F_k(self) -> float:
        """Friction force of the contact that yields at the amplitudes seen, N."""
        return self.sliders.F_k

    def loss(self, X: Array | float, omega: Array | float) -> Band:
        """Return the energy lost per cycle at amplitudes X, m, and angular frequencies, rad/s, with its interval, J,
        each (n,).

        Raises ValueError outside of the amplitudes seen.
        """
        X = self._inside(X)
        omega = np.broadcast_to(np.asarray(omega, dtype=np.float64), X.shape)
        return self._band(X, omega, self.terms, lambda Z: math.pi * X**2 * Z.imag)

    def stiffness(self, X: Array | float, omega: Array | float = 0.0) -> Band:
        """Return the stiffness of the fundamental, k + ¾k_3X² − mω² + Σ κ Re D, at amplitudes X, m, with its interval,
        N/m, each (n,).

        omega : rad/s. At 0 the error is mostly that of k. Lines near a resonance tell k and mω² far less well than
        their difference: at the resonance the interval shows how well the change with X is known.

        Raises ValueError outside of the amplitudes seen.
        """
        X = self._inside(X)
        omega = np.broadcast_to(np.asarray(omega, dtype=np.float64), X.shape)
        return self._band(X, omega, ("k", "k_3", "m"), lambda Z: Z.real)

    @one_thread
    def changed(self, Z: Complexes, X: float = 1.0, **given: float) -> dict[str, float]:
        """Return unknowns, K_z and F_k of the fit with the same smoothing to other lines, by name.

        Use it for what gains, phases and given values do to an answer.

        Z, X : factors of each Z, (n,), and of all amplitudes.   given : values instead of those that are given.
        """
        own, size, residual = self.design.rows, np.abs(Z), "R" in self.values
        known = {**own.given, **given}
        stiffness = own.stiffness and known["k"]
        rows = replace(
            own,
            lines=replace(own.lines, X=X * own.lines.X, Z=Z * own.lines.Z),
            given=known,
            stiffness=stiffness,
            parts={name: stiffness_part(name, own.lines.omega, stiffness) for name in own.parts},
            sigma=size * own.sigma,
            R=own.R / float(np.mean(size)),
        )
        design = replace(self.design, rows=rows, nodes=X * self.design.nodes)
        for _ in range(_REPEATS):
            found = ContactEstimate(
                design, design.solve(rows.target, self.smoothing), self.smoothing
            )
            rows = replace(rows, sigma=found.scatter(residual))
            found = replace(found, design=replace(design, rows=rows))
            design = _with_R(found) if residual else found.design
        point, largest = design.solve(rows.target, self.smoothing), rows.mode.X.max()
        slips = Sliders(*(of[point.r < largest] for of in (point.r, point.kappa)))
        free = dict(zip(rows.free, point.linear.tolist(), strict=True))
        return free | {"K_z": slips.K_z, "F_k": slips.F_k}

    def _inside(self, X: Array | float) -> Array:
        X = np.atleast_1d(np.asarray(X, dtype=np.float64))
        low, high = self.X_range
        if not (X.min() >= low * (1.0 - 1e-9) and X.max() <= high * (1.0 + 1e-9)):
            raise ValueError(
                f"the law is fitted to amplitudes from {low:.4g} to {high:.4g} m, got {X.min():.4g} to "
                f"{X.max():.4g} m: keep within them, or measure there"
            )
        return X

    @one_thread
    def _band(
        self, X: Array, omega: Array, names: Sequence[str], of: Callable[[Complexes], Array]
    ) -> Band:
        names = [name for name in names if name in self.values]
        columns = [stiffness_part(name, omega, self.design.rows.stiffness) for name in names]
        parts = np.array([size * X**power for size, power in columns])
        drawn = self.draws
        given = {name: np.full(len(drawn.r), self.values[name]) for name in names}
        values = np.array(
            [[self.values[name], *drawn.linear.get(name, given[name])] for name in names]
        )
        r, kappa = np.vstack([self.r, drawn.r]), np.vstack([self.kappa, drawn.kappa])
        alike = bool((r == r[0]).all())  # as of a gradual contact, with its nodes
        Z = kappa @ secant(X, r[0]).T if alike else kappa * secant(X, r[:, 0]).T
        all_Z = of(Z + values.T @ parts) if names else of(Z)
        return Band(all_Z[0], *_interval(all_Z[0], all_Z[1:]))


def _interval(value: Array, drawn: Array) -> tuple[Array, Array]:
    """Return interval of 95 % from replicates along the first axis, after the law that they are drawn about: by their
    standard deviation and by their bias, which smoothing causes; it is not subtracted, as it is uncertain itself."""
    bias = np.mean(drawn[1:], axis=0) - drawn[0]
    half = _NORMAL * np.hypot(np.std(drawn[1:], axis=0, ddof=1), bias)
    return value - half, value + half


@one_thread
def fit_contact(
    lines: SteppedLines,
    *,
    contact: Contact,
    terms: Sequence[str] = ("c",),
    given: Mapping[str, float] | None = None,
    stiffness: float | None = None,
    mass: float | None = None,
    hardening: bool = True,
    residual: bool = False,
) -> ContactFit:
    """Identify a contact and the damping from steady responses at several amplitudes.

    Use it for tables of a stepped sine. "one slider" is the contact of the paper; a bolted joint, which yields
    gradually, needs "gradual"; `compare_contacts` says which one the lines support.

    lines : steady responses.
    contact : "none", "one slider" or "gradual".
    terms : of the damping in addition to the contact, of `law.terms.KNOWN_TERMS`.
    given : coefficients of terms that are known.
    stiffness, mass : k, N/m, and m, kg, where they are known.
    hardening : whether the spring may stiffen, ¾k_3X².
    residual : whether other modes move the driven point, too: R.

    Raises ValueError for lines that do not determine the unknowns.
    """
    rows = _asked(lines, contact, terms, given or {}, stiffness, mass, hardening)
    return _fitted(estimated(rows, contact, residual), tuple(terms), residual)


def _asked(
    lines: SteppedLines,
    contact: Contact,
    terms: Sequence[str],
    given: Mapping[str, float],
    stiffness: float | None,
    mass: float | None,
    hardening: bool,
) -> StiffnessRows:
    """Return rows of what was asked for, with the errors to start from. Raises ValueError."""
    low, high = lines.X.min(), lines.X.max()
    alike = high < _ALIKE * low
    if contact != "none" and alike:
        raise ValueError(
            f"the amplitudes of all lines are alike, {low:.4g} to {high:.4g} m, and a contact shows only in changes "
            "with the amplitude: add levels of excitation"
        )
    own = {"k": stiffness, "m": mass} | {name: given.get(name) for name in terms}
    free = [name for name, value in own.items() if value is None]
    free += ["k_3"] * (hardening and not alike)
    known = {name: value for name, value in own.items() if value is not None}
    parts = {name: stiffness_part(name, lines.omega, stiffness) for name in (*own, "k_3")}
    first = _FIRST_ERROR * np.abs([lines.Z] * 2)
    rows = StiffnessRows(lines, tuple(free), known, stiffness, parts, first)
    unknowns = len(free) + {"none": 0, "one slider": 2, "gradual": 6}[contact]
    if 2 * lines.X.size < unknowns + 2:
        raise ValueError(
            f"{lines.X.size} lines are too few for {unknowns} unknowns: add lines or levels, or state stiffness or mass"
        )
    columns = rows.linear / np.linalg.norm(rows.linear, axis=0)
    if free and np.linalg.svd(columns, compute_uv=False)[-1] < _SINGULAR:
        raise ValueError(
            f"the lines do not separate {', '.join(free)}: add lines at other frequencies or levels, or state "
            "stiffness or mass"
        )
    return rows


def _fitted(found: ContactEstimate, terms: tuple[str, ...], residual: bool) -> ContactFit:
    """Return the estimate with its intervals, from replicates of the lines about a law that is smoothed less still."""
    rows, point, contact = found.rows, found.point, found.design.contact
    design = _with_R(found) if residual else found.design
    about = design.solve(rows.target, LESS * found.smoothing)
    law = rows.weighted(rows.law(about) - rows.known)
    targets = law + _noise(law.size)
    points = [about, *design.solve_each(targets, found.smoothing)]
    draws = _Draws(
        dict(zip(rows.free, np.array([one.linear for one in points]).T, strict=True)),
        np.array([one.r for one in points]),
        np.array([one.kappa for one in points]),
    )
    reach = rows.mode.X
    values = dict(rows.given) | dict(zip(rows.free, point.linear.tolist(), strict=True))
    estimates, drawn = {name: values[name] for name in rows.free}, dict(draws.linear)
    if residual:
        laws = np.array([rows.weighted(rows.law(one) - rows.known) for one in points])
        values["R"] = estimates["R"] = rows.R
        change = _of_receptance(found)
        drawn["R"] = rows.R + (np.vstack([law, targets]) - laws) @ change / float(change @ change)
    if contact != "none":
        for name, power in (("K_z", 0), ("F_k", 1)):
            parts = [one.kappa * one.r**power * (one.r < reach.max()) for one in (point, draws)]
            estimates[name], drawn[name] = float(np.sum(parts[0])), np.sum(parts[1], axis=1)
    if contact == "one slider":
        estimates["r"], drawn["r"] = float(point.r[0]), draws.r[:, 0]
    intervals = {}
    for name, of in drawn.items():
        low, high = (float(end) for end in _interval(np.array(estimates[name]), of))
        intervals[name] = (low if name == "R" else max(low, 0.0), high)
    if contact == "one slider":
        near = design.with_each_slider(rows.target)
        best = min(one.chi_square for one in (*near, design.solve(rows.target)))
        allowed = [one.chi_square < best + _CHI_SQUARE for one in near]
        if allowed[0]:
            lowest = min(float(one.kappa[0]) for one, may in zip(near, allowed, strict=True) if may)
            intervals["K_z"] = (lowest, math.inf)
    return ContactFit(
        contact,
        terms,
        values,
        point.r,
        point.kappa,
        {name: float(np.std(of[1:], ddof=1)) for name, of in drawn.items()},
        intervals,
        rows.law(point).imag / rows.mode.Z.imag - 1.0,
        rows.misfit(point),
        (float(reach.min()), float(reach.max())),
        found.smoothing,
        _of_k(found, residual),
        design,
        draws,
        drawn,
    )


def _noise(size: int) -> Array:
    """Return standard normal errors of the rows of replicates, (_DRAWS, size)."""
    return np.random.default_rng(_SEED).standard_normal((_DRAWS, size))


def _of_k(found: ContactEstimate, residual: bool) -> tuple[float, float] | None:
    """Return where k is given, that of the same contact with k free and the χ² that it saves, with the errors of that
    fit.

    A gradual contact holds a slider that sticks: with it, only a k that is too large is contradicted.
    """
    own = found.rows
    if "k" not in own.given:
        return None
    others = {name: value for name, value in own.given.items() if name != "k"}
    asked = replace(own, free=("k", *own.free), given=others, R=0.0)
    free = estimated(asked, found.design.contact, residual)
    best = _with_R(free) if residual else free.design
    held = replace(best, rows=replace(free.rows, free=own.free, given=own.given))
    less, more = (one.solve(one.rows.target, free.smoothing) for one in (held, best))
    return float(more.linear[0]), less.chi_square - more.chi_square


def _with_R(found: ContactEstimate) -> Design:
    """Return the design with R among its unknowns."""
    change = _of_receptance(found)
    return replace(found.design, direction=change / np.linalg.norm(change))


def _of_receptance(found: ContactEstimate) -> Array:
    """Change of the rows of the law, less those measured, with R, (2n,)."""
    step = 1e-4 / float(np.abs(found.rows.lines.Z).max())
    sides = [replace(found.rows, R=found.rows.R + sign * step) for sign in (-1.0, 1.0)]
    low, high = (side.weighted(side.law(found.point) - side.mode.Z) for side in sides)
    return np.asarray((high - low) / (2.0 * step))


@dataclass(frozen=True, eq=False)
class ContactTrial:
    """A contact that was compared.

    name : "gradual", "one slider" or "none" with its terms.   fit : to all lines.   held_out : misfit of each level to
    the law of the others, in the standard errors of the gradual contact.
    """

    name: str
    fit: ContactFit
    held_out: tuple[Misfit, ...]

    def scores(self, which: str = "score") -> Array:
        """Return mean square misfit of each level, in standard errors."""
        return np.array([getattr(misfit, which) for misfit in self.held_out])

    def as_good_as(self, other: ContactTrial, which: str = "score") -> bool:
        """Return whether levels are predicted as well, within one standard error of the difference."""
        return as_good(self.scores(which), other.scores(which))


@dataclass(frozen=True, eq=False)
class ContactComparison:
    """Which contact stepped lines support.

    trials : simplest first.
    supported : name of the simplest one that predicts levels as well as the best does.
    p : probability, for one slider, of a misfit that exceeds that of a gradual contact by as much.
    indistinguishable : others that predict as well.
    by_stiffness : those that predict the loss as well, and not the in-phase rows.
    """

    trials: tuple[ContactTrial, ...]
    supported: str
    p: float
    indistinguishable: tuple[str, ...]
    by_stiffness: tuple[str, ...]

    def __getitem__(self, name: str) -> ContactTrial:
        return next(trial for trial in self.trials if trial.name == name)

    def finding(self) -> Finding:
        """Return which contact it is, and what does not distinguish it from others."""
        chosen = self[self.supported]
        loss, stiffness = chosen.fit.misfit[:2]
        numbers: dict[str, Any] = {
            "contact": _WORDS[chosen.fit.contact],
            "terms": tuple(chosen.fit.terms),
            **{"loss": loss, "stiffness": stiffness, "others": self.indistinguishable},
        }
        if self.supported in ("one slider", "gradual"):
            numbers |= {"p": self.p, "tested": True, "enough": self.supported == "one slider"}
        others = [(name, self[name].fit.misfit) for name in self.by_stiffness]
        numbers["stiffer"] = tuple(
            Finding("other contact", {"contact": name, "loss": of.loss, "stiffness": of.in_phase})
            for name, of in others
        )
        return Finding("contact", numbers)


@one_thread
def compare_contacts(
    lines: SteppedLines,
    *,
    terms: Sequence[str] = ("c",),
    given: Mapping[str, float] | None = None,
    stiffness: float | None = None,
    mass: float | None = None,
    hardening: bool = True,
    residual: bool = False,
) -> ContactComparison:
    """Compare no contact, with damping up to a cubic one, a single slider and a gradual contact.

    Use it before an answer is taken from stepped lines. Each level is left out and predicted by the law of the others.
    The simplest contact is supported that predicts as well as the best one, within one standard error of the difference
    over levels; a gradual contact only if, in addition, the ratio of likelihoods rejects one slider at 5 %; replicates
    of the lines about one slider give its distribution.

    Arguments as for `fit_contact`. Raises ValueError for fewer than three levels.
    """
    if len(lines.names) < _COMPARED:
        raise ValueError(
            f"contacts are compared by held-out levels, and there are {len(lines.names)}: add levels of excitation, "
            f"{_COMPARED} at least, or ask for one contact"
        )
    more = [name for name in ("c_2", "c_3") if name not in terms]
    laws: dict[str, tuple[Contact, tuple[str, ...]]] = {
        f"none ({', '.join(of)})": ("none", of)
        for of in ((*terms, *more[:count]) for count in range(len(more) + 1))
    }
    laws = dict(sorted([*laws.items(), ("one slider", ("one slider", tuple(terms)))], key=_size))
    laws["gradual"] = ("gradual", tuple(terms))
    asked = {
        name: _asked(lines, contact, of, given or {}, stiffness, mass, hardening)
        for name, (contact, of) in laws.items()
    }
    own = {name: estimated(asked[name], laws[name][0], residual) for name in laws}
    sigma = own["gradual"].rows.sigma
    alike = {
        name: estimated(replace(rows, sigma=sigma), laws[name][0], residual, steps=1)
        for name, rows in asked.items()
    }
    trials = [
        ContactTrial(
            name,
            _fitted(own[name], laws[name][1], residual),
            tuple(found.held_out(found.smoothing)),
        )
        for name, found in alike.items()
    ]
    p = _one_slider_is_enough(alike["one slider"], alike["gradual"], residual)
    best = min(trials, key=lambda trial: float(np.mean(trial.scores())))
    good = [trial for trial in trials if trial.as_good_as(best)]
    supported = good[0].name
    if supported == "gradual" and p > _FALSE_ALARMS:
        supported = "one slider"
    chosen = next(trial for trial in trials if trial.name == supported)
    others = [trial for trial in trials if trial.name != supported]
    by_stiffness = [
        trial.name
        for trial in others
        if trial not in good and trial.as_good_as(chosen, "loss_score")
    ]
    return ContactComparison(
        tuple(trials),
        supported,
        p,
        tuple(trial.name for trial in others if trial in good),
        tuple(by_stiffness),
    )


def _one_slider_is_enough(one: ContactEstimate, gradual: ContactEstimate, residual: bool) -> float:
    """Return probability, if one slider is the truth, that a gradual contact fits better by as much as it does."""
    designs = [
        (_with_R(found) if residual else found.design, found.smoothing) for found in (one, gradual)
    ]
    law = one.rows.weighted(one.rows.law(one.point) - one.rows.mode.Z)
    moved = np.vstack([np.zeros(law.size), law + _noise(law.size)])
    of_one, of_many = (
        np.array(
            [point.chi_square for point in design.solve_each(design.rows.target + moved, smoothing)]
        )
        for design, smoothing in designs
    )
    gain = of_one - of_many
    return float(1.0 + np.count_nonzero(gain[1:] >= gain[0])) / (_DRAWS + 1.0)


def _size(law: tuple[str, tuple[Contact, tuple[str, ...]]]) -> float:
    """Return the number of unknowns of a law; one slider comes before a damping with as many."""
    contact, terms = law[1]
    return len(terms) + 1.5 * (contact == "one slider")
