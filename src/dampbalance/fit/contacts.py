"""Contact, damping, stiffness and mass from steady responses to a harmonic force, with intervals; which contact it is.

Equations and unknowns are those of `stiffness_lines.py`. The errors of the lines are what the law leaves of them; a
gradual contact is a tenth as smooth as the prediction of levels that are left out asks for, so that its bias is below
the noise.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from scipy import special

from ..arrays import Array, Complexes
from ..findings.finding import Finding
from ..law.contact import Sliders
from ..law.terms import FRICTION, term
from ..signals.one_thread import one_thread
from .fit import Fit
from .goodness import as_good
from .parameters import Parameter, Parameters
from .stiffness_lines import (
    NODES,
    Contact,
    Misfit,
    StiffnessLines,
    StiffnessProblem,
    stiffness_part,
)

_SMOOTHINGS = np.geomspace(1e-3, 10.0, 5)
_LESS = 0.1  # part of the smoothing that predicts best
_LEVELS = 4  # from which on levels are left out to choose it
_RECEPTANCES, _LARGEST_RECEPTANCE = 25, 0.6  # values of R that are tried, in 1/|Z|
_ITERATIONS = 4  # of the errors of the lines
_REPEATS = 3  # of those of changed lines, which start from those of the fit
_FIRST_ERROR = 0.05  # of Z, where the iteration starts
_ALIKE = 1.05  # of amplitudes: closer ones count as one
_SINGULAR = 1e-7  # smallest singular value of columns of length one
_STIFFEST = 1e10  # of |Z|: a contact that stands for a rigid one
_DRAWS, _SEED = 200, 2010  # of replicates; the same lines give the same bytes
_COMPARED = 3  # levels, at least
_WORDS = {
    "none": "no contact",
    "one slider": "one slider",
    "gradual": "a contact that yields gradually",
}
_FALSE_ALARMS = 0.05  # of a gradual contact where one slider is the truth
_SPRING = ("k", "m", "k_3")


class Band(NamedTuple):
    """A value and its interval of 95 %, each an array: loss per cycle in J, or stiffness in N/m."""

    value: Array
    low: Array
    high: Array


@dataclass(frozen=True, eq=False)
class ContactFit(Fit):
    """A contact and an oscillator identified from lines of dynamic stiffness.

    problem : a `StiffnessProblem`.   covariance : with the square of the bias that smoothing causes; it is not
    subtracted, as it is uncertain itself.
    """

    @property
    def contact(self) -> Contact:
        """The contact of the law."""
        contact: Contact = self.problem.contact
        return contact

    @property
    def terms(self) -> tuple[str, ...]:
        """Terms of the damping, the contact apart."""
        return tuple(n for n in self.parameters.names if n not in (*_SPRING, *_OF_CONTACT))

    @property
    def given(self) -> dict[str, float]:
        """Values that are given, SI units."""
        return {p.name: p.value for p in self.parameters if not p.free}

    @property
    def values(self) -> dict[str, float]:
        """k, m, k_3, R and the coefficients of the terms, SI units, the given ones too."""
        return {
            p.name: p.value for p in self.parameters if p.name not in (FRICTION, "rho", "kappa")
        }

    @cached_property
    def all_sliders(self) -> Sliders:
        """Sliders of the contact, those that slip at no amplitude seen, too."""
        sliders: Sliders = self.problem.sliders(self.point)
        return sliders

    @property
    def sliders(self) -> Sliders:
        """Those that slip at the amplitudes seen."""
        every, slips = self.all_sliders, self.all_sliders.r < self.X_range[1]
        return Sliders(every.r[slips], every.kappa[slips])

    @property
    def stuck(self) -> float:
        """Stiffness of the contact that slips at none of the amplitudes seen, N/m; 0 unless k is given."""
        return self.all_sliders.K_z - self.K_z

    @property
    def K_z(self) -> float:
        """Stiffness of the contact that yields at the amplitudes seen, N/m."""
        return self.sliders.K_z

    @property
    def F_k(self) -> float:
        """Friction force of the contact that yields at the amplitudes seen, N."""
        return self.sliders.F_k

    @cached_property
    def X_range(self) -> tuple[float, float]:
        """Amplitudes that were seen, m."""
        X = self.problem.mode(self.point).X
        return float(X.min()), float(X.max())

    @cached_property
    def misfit_of_lines(self) -> Misfit:
        """Distance of the lines from the law."""
        misfit: Misfit = self.problem.misfit(self.point)
        return misfit

    @cached_property
    def residuals(self) -> Array:
        """(loss of the law)/W − 1 of each line, (n,)."""
        mode = self.problem.mode(self.point)
        return np.asarray(self.problem.law(self.point, mode).imag / mode.Z.imag - 1.0)

    @cached_property
    def slopes(self) -> dict[str, Array]:
        """Derivatives of the numbers that are not given, F_k and K_z among them, by the unknowns, (p,) each."""
        unit = np.eye(len(self.parameters))
        found = {
            p.name: row
            for p, row in zip(self.parameters, unit, strict=True)
            if p.free and p.name not in ("rho", "kappa")
        }
        if self.contact == "gradual":
            kappa, r = np.array(self.parameters.names) == "kappa", self.all_sliders.r
            for name, power in (("K_z", 0), (FRICTION, 1)):
                of = (r**power * (r < self.X_range[1])) @ self.problem.spread
                found[name] = np.zeros(len(self.parameters))
                found[name][kappa] = of
        elif self.contact == "one slider":
            rho = self.parameters.places["rho"]
            found["K_z"] = -2.0 * self.value("rho") ** -3 * unit[rho]
        return found

    @property
    def _t(self) -> float:
        return float(special.stdtrit(self.freedom, 0.975))

    @cached_property
    def errors(self) -> dict[str, float]:
        """Standard errors of these numbers."""
        return {name: math.sqrt(by @ self.covariance @ by) for name, by in self.slopes.items()}

    @cached_property
    def intervals(self) -> dict[str, tuple[float, float]]:
        """Intervals of 95 % of these numbers. The upper end of K_z is infinite where lines tell only a lower limit."""
        at = {**self.values, FRICTION: self.F_k, "K_z": self.K_z}
        ends = {}
        for name, error in self.errors.items():
            low = at[name] - self._t * error
            ends[name] = low if name == "R" else max(low, 0.0), at[name] + self._t * error
        if self.contact == "one slider":  # by that of ρ
            low, high = self.interval("rho")
            ends["K_z"] = high**-2, (low**-2 if low > self.parameters["rho"].low else math.inf)
        return ends

    def covariance_of_values(self, *names: str) -> Array:
        """Return the covariance of numbers by name."""
        by = np.array([self.slopes[name] for name in names]).reshape(len(names), self.point.size)
        return np.asarray(by @ self.covariance @ by.T)

    def loss(self, X: Array | float, omega: Array | float) -> Band:
        """Return the energy lost per cycle at amplitudes X, m, and angular frequencies, rad/s, with its interval, J,
        each (n,).

        Raises ValueError outside of the amplitudes seen.
        """
        Z, reach = self._law(X, omega, np.imag)
        size = math.pi * np.atleast_1d(X) ** 2
        return Band(size * Z, size * (Z - reach), size * (Z + reach))

    def stiffness(self, X: Array | float, omega: Array | float = 0.0) -> Band:
        """Return the stiffness of the fundamental, k + ¾k_3X² − mω² + Σ κ Re D, at amplitudes X, m, with its interval,
        N/m, each (n,).

        omega : rad/s. At 0 the error is mostly that of k. Lines near a resonance tell k and mω² far less well than
        their difference: at the resonance the interval shows how well the change with X is known.

        Raises ValueError outside of the amplitudes seen.
        """
        Z, reach = self._law(X, omega, np.real)
        return Band(Z, Z - reach, Z + reach)

    def _law(self, X: Array | float, omega: Array | float, part: Any) -> tuple[Array, Array]:
        """Return a part of Z by the law, and half of its interval, N/m, (n,) each."""
        X = np.atleast_1d(np.asarray(X, dtype=np.float64))
        low, high = self.X_range
        if not (X.min() >= low * (1.0 - 1e-9) and X.max() <= high * (1.0 + 1e-9)):
            raise ValueError(
                f"the law is fitted to amplitudes from {low:.4g} to {high:.4g} m, got {X.min():.4g} to "
                f"{X.max():.4g} m: keep within them, or measure there"
            )
        there = self.problem.on(X, np.broadcast_to(np.asarray(omega, dtype=np.float64), X.shape))
        values = np.where(np.isin(self.parameters.names, ("R", "delay")), 0.0, self.point)
        rows = there.slopes(values, self.parameters.free)
        rows[:, there.solved] = there.rows(values)[: there.samples]
        by = part(rows[: X.size] + 1j * rows[X.size :])
        error = np.sqrt(np.einsum("ni,ij,nj->n", by, self.covariance, by))
        return np.asarray(part(there.law(values))), self._t * error

    @cached_property
    def shown(self) -> tuple[float, float] | None:
        """Where k is given, that of the lines if it is free and the χ² that it saves, with the errors of that fit.

        A gradual contact holds a slider that sticks: with it, only a k that is too large is contradicted.
        """
        if "k" not in self.given:
            return None
        free = self.problem.start.freed("k").at(self.point)
        free = replace(free, low=np.where(np.array(free.keys) == "k", 0.0, free.low))
        more = _estimated(replace(self.problem, start=free), _ITERATIONS)
        held = more.start.held("k").moved(k=self.value("k"))
        less = replace(more, start=held)
        chi = [np.sum(p.residual(p.solve(p.ends([p.climbed]).values)) ** 2) for p in (less, more)]
        return more.start["k"].value, float(chi[0] - chi[1])

    @one_thread
    def changed(self, Z: Complexes, X: float = 1.0, **given: float) -> dict[str, float]:
        """Return unknowns, K_z and F_k of the fit with the same smoothing to other lines, by name.

        Use it for what gains, phases and given values do to an answer.

        Z, X : factors of each Z, (n,), and of all amplitudes.   given : values instead of those that are given.
        """
        own = self.problem
        lines = replace(own.lines, X=X * own.lines.X, Z=Z * own.lines.Z)
        start = own.start.at(self.point).moved(**given)
        k = given.get("k", own.k)
        problem = replace(
            own, lines=lines, start=start, k=k, sigma=np.abs(Z) * own.sigma, nodes=X * own.nodes
        ).prepared()
        for _ in range(_REPEATS):
            problem = replace(problem, start=problem.ends([problem.climbed]))
            problem = replace(problem, sigma=problem.scatter(problem.start.values))
        found = _fit(replace(problem, start=problem.ends([problem.climbed])))
        return found.values | {"K_z": found.K_z, FRICTION: found.F_k}


_OF_CONTACT = (FRICTION, "rho", "kappa", "R", "delay")


@one_thread
def fit_contact(lines: StiffnessLines, *, contact: Contact, **options: Any) -> ContactFit:
    """Identify a contact and the damping from steady responses at several amplitudes.

    Use it for tables of a stepped sine, and for the fundamentals of forced records. "one slider" is the contact of the
    paper; a bolted joint, which yields gradually, needs "gradual"; `compare_contacts` says which one the lines support.

    lines : steady responses.
    contact : "none", "one slider" or "gradual".
    terms : of the damping in addition to the contact, of `law.terms.KNOWN_TERMS`; default, c.
    given : coefficients of terms that are known.
    stiffness, mass : k, N/m, and m, kg, where they are known.
    hardening : whether the spring may stiffen, ¾k_3X²; default, it may.
    residual : whether other modes move the driven point, too: R; default, they do not.

    Raises ValueError for lines that do not determine the unknowns.
    """
    return _fit(_estimated(_asked(lines, contact, **options)))


def _asked(
    lines: StiffnessLines,
    contact: Contact,
    terms: Sequence[str] = ("c",),
    given: Mapping[str, float] | None = None,
    stiffness: float | None = None,
    mass: float | None = None,
    hardening: bool = True,
    residual: bool = False,
) -> StiffnessProblem:
    """Return the problem of what was asked for, with the errors to start from. Raises ValueError."""
    low, high = float(lines.X.min()), float(lines.X.max())
    alike, largest = high < _ALIKE * low, float(np.abs(lines.Z).max())
    if contact != "none" and alike:
        raise ValueError(
            f"the amplitudes of all lines are alike, {low:.4g} to {high:.4g} m, and a contact shows only in changes "
            "with the amplitude: add levels of excitation"
        )
    for name in terms:
        _require_told(name, stiffness)
    own = {"k": stiffness, "m": mass} | {name: (given or {}).get(name) for name in terms}
    own |= {"k_3": None} if hardening and not alike else {}
    unknowns = [Parameter(s, v or 0.0, low=0.0, free=v is None) for s, v in own.items()]
    if contact == "one slider":
        rigid = (_STIFFEST * largest) ** -0.5
        unknowns += [Parameter(FRICTION, 0.0, low=0.0, scale=1e-3 * largest * low)]
        unknowns += [Parameter("rho", largest**-0.5, low=rigid, scale=rigid)]
    nodes = np.geomspace(0.1 * low, high, NODES * (contact == "gradual"))
    # where k is free, a slider that no line moves is a part of it
    count = nodes.size + (contact == "gradual" and stiffness is not None)
    unknowns += [Parameter("kappa", 0.0, low=0.0, group=str(1 + i)) for i in range(count)]
    unknowns += [Parameter("R", 0.0, scale=1e-2 / largest)] * residual
    sigma = np.abs([lines.Z] * 2) * (_FIRST_ERROR if lines.error is None else lines.error)
    start, k = Parameters.of(unknowns), stiffness or 1.0
    problem = StiffnessProblem(lines, start, contact, sigma, k, nodes=nodes)
    free = [p.name for p in unknowns if p.free and p.name not in _OF_CONTACT]
    count = len(free) + {"none": 0, "one slider": 2, "gradual": 6}[contact]
    if 2 * lines.X.size < count + 2:
        raise ValueError(
            f"{lines.X.size} lines are too few for {count} unknowns: add lines or levels, or state stiffness or mass"
        )
    parts = [stiffness_part(name, lines, k) for name in free]
    columns = problem.weighted(np.reshape(parts, (len(free), lines.X.size)).T, start.values)
    size = np.linalg.norm(columns, axis=0)
    if free and np.linalg.svd(columns / size, compute_uv=False)[-1] < _SINGULAR:
        raise ValueError(
            f"the lines do not separate {', '.join(free)}: add lines at other frequencies or levels, or state "
            "stiffness or mass"
        )
    return problem


def _require_told(name: str, stiffness: float | None) -> None:
    """Raise ValueError for a term that lines do not tell."""
    of = term(name)
    if of.force is None:
        raise ValueError(f'{FRICTION} belongs to the contact: ask for contact="one slider"')
    if of.linear and of.force(0.0, 1.0, 1.0, 1.0):
        raise ValueError(
            f"{name} acts against the base, whose motion the lines do not contain: use c"
        )
    if stiffness is None and of.force(1.0, 0.0, 2.0, 1.0) != of.force(1.0, 0.0, 1.0, 1.0):
        raise ValueError(f"the force of {name} depends on the spring: state stiffness")


def _estimated(problem: StiffnessProblem, steps: int = _ITERATIONS) -> StiffnessProblem:
    """Return the problem with its unknowns where they are likeliest, its smoothing and its errors iterated; with one
    step, those of the lines are kept."""
    smoothing = problem.smoothing or _LESS * float(np.median(_SMOOTHINGS))
    problem = replace(problem, smoothing=smoothing * (problem.contact == "gradual")).prepared()
    starts = _starts(problem)
    for step in range(steps):
        problem = replace(problem, start=problem.ends(starts))
        if problem.contact == "gradual":
            problem = _smoothed(problem)
        if step < steps - 1:
            problem = replace(problem, sigma=problem.scatter(problem.start.values))
            starts = [problem.climbed, *_starts(problem)]
    return problem


def _starts(problem: StiffnessProblem) -> list[Parameters]:
    """Return where climbs start: each R, and the best slider with it."""
    most, each = _LARGEST_RECEPTANCE / float(np.abs(problem.lines.Z).max()), [problem.climbed]
    if "R" in problem.start and problem.start["R"].free:
        tried = np.linspace(-most, most, _RECEPTANCES)
        each = [problem.climbed.moved(R=R) for R in tried.tolist()]
    if problem.contact == "one slider":
        each = [one.at(problem.with_sliders(one.values)) for one in each]
    if len(each) == 1:
        return each
    chi_square = [float(np.sum(problem.residual(problem.solve(one.values)) ** 2)) for one in each]
    return [each[i] for i in np.argsort(chi_square, kind="stable")[:3]]


def _smoothed(problem: StiffnessProblem) -> StiffnessProblem:
    """Return the problem with the smoothing that levels, or generalised cross-validation where they are few, ask for,
    solved."""
    rough = [replace(problem, smoothing=smoothing) for smoothing in _SMOOTHINGS.tolist()]
    if len(problem.lines.names) >= _LEVELS:
        scores = [float(np.mean([one.score for one in _held_out(of)])) for of in rough]
    else:
        scores = [_generalised(of) for of in rough]
    best = replace(problem, smoothing=_LESS * float(_SMOOTHINGS[int(np.argmin(scores))]))
    return replace(best, start=best.start.at(best.solve(best.start.values)))


def _generalised(problem: StiffnessProblem) -> float:
    """Return χ² over the square of the degrees of freedom that are left."""
    values = problem.solve(problem.start.values)
    A = problem.rows(values)[:, values[problem.solved] > 0.0]
    A = A / np.linalg.norm(A, axis=0)
    own = A[: problem.samples]
    freedom = problem.samples - float(np.trace(np.linalg.pinv(A.T @ A) @ (own.T @ own)))
    return float(np.sum(problem.residual(values) ** 2)) / max(freedom, 1e-9) ** 2


def _held_out(problem: StiffnessProblem) -> list[Misfit]:
    """Return misfit of each level to the law of the others."""
    held, found = problem.start, []
    problem = replace(problem, start=held.held("R") if "R" in held else held)
    for level in range(len(problem.lines.names)):
        own = problem.lines.level == level
        if not own.all():
            others = problem[~own]
            at = others.ends([others.climbed, *_starts(others)])
            found.append(problem[own].misfit(at.values))
    return found


def _fit(problem: StiffnessProblem) -> ContactFit:
    """Return the fit where the unknowns of a problem are."""
    values = problem.start.values
    by = problem.by_rows(values)
    covariance = by @ by.T
    if problem.contact == "gradual":
        about = replace(problem, smoothing=_LESS * problem.smoothing).solve(values)
        moved = problem.residual(about)
        noise = np.random.default_rng(_SEED).standard_normal((_DRAWS, moved.size))
        drawn = problem.refitted(moved + noise)[0] - about
        covariance = np.cov(drawn.T) + np.outer(drawn.mean(axis=0), drawn.mean(axis=0))
    chi_square = float(np.sum(problem.residual(values) ** 2))
    freedom = problem.samples - np.count_nonzero(problem.used(values))
    return ContactFit(problem.start, covariance, chi_square, max(float(freedom), 1.0), problem)


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
        chosen = self[self.supported].fit
        loss, stiffness = chosen.misfit_of_lines[:2]
        numbers: dict[str, Any] = {
            "contact": _WORDS[chosen.contact],
            "terms": chosen.terms,
            **{"loss": loss, "stiffness": stiffness, "others": self.indistinguishable},
        }
        if self.supported in ("one slider", "gradual"):
            numbers |= {"p": self.p, "tested": True, "enough": self.supported == "one slider"}
        others = [(name, self[name].fit.misfit_of_lines) for name in self.by_stiffness]
        numbers["stiffer"] = tuple(
            Finding("other contact", {"contact": name, "loss": of.loss, "stiffness": of.in_phase})
            for name, of in others
        )
        return Finding("contact", numbers)


@one_thread
def compare_contacts(
    lines: StiffnessLines, *, terms: Sequence[str] = ("c",), **options: Any
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
    asked = {n: _asked(lines, contact, of, **options) for n, (contact, of) in laws.items()}
    own = {name: _estimated(problem) for name, problem in asked.items()}
    sigma = own["gradual"].sigma
    alike = {n: _estimated(replace(own[n], sigma=sigma), steps=1) for n in laws}
    trials = [ContactTrial(n, _fit(own[n]), tuple(_held_out(alike[n]))) for n in laws]
    p = _one_slider_is_enough(alike["one slider"], alike["gradual"])
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


def _one_slider_is_enough(one: StiffnessProblem, gradual: StiffnessProblem) -> float:
    """Return probability, if one slider is the truth, that a gradual contact fits better by as much as it does."""
    law = one.residual(one.start.values)
    random = np.random.default_rng(_SEED).standard_normal((_DRAWS, law.size))
    moved = np.vstack([np.zeros(law.size), law + random])
    of_one, of_many = (np.sum(of.refitted(moved)[1] ** 2, axis=1) for of in (one, gradual))
    gain = of_one - of_many
    return float(1.0 + np.count_nonzero(gain[1:] >= gain[0])) / (_DRAWS + 1.0)


def _size(law: tuple[str, tuple[Contact, tuple[str, ...]]]) -> float:
    """Return the number of unknowns of a law; one slider comes before a damping with as many."""
    contact, terms = law[1]
    return len(terms) + 1.5 * (contact == "one slider")
