"""Contact, damping, stiffness and mass from steady responses to a harmonic force, with intervals; which contact it is.

Equations and unknowns are those of `stiffness_lines.py`; the errors of the lines follow from the residual of each
model. A gradual contact is the mean over contacts of different smoothness, from separate sliders on, weighed like none,
one slider and many sliders by their evidence (`select.py`),

    ln E = −Σ ln σ − ½χ² − ½ p ln n

with the errors σ that are likeliest by each model, n data and p effective unknowns (Schwarz, Ann. Stat. 6, 1978).
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from scipy import special

from ..arrays import Array, Complexes
from ..law.contact import Sliders
from ..law.terms import FRICTION, term
from ..signals.one_thread import one_thread
from .fit import Fit
from .parameters import Parameter, Parameters
from .select import PRIORS, Candidate, Selection, noise_of, select
from .stiffness_lines import Contact, StiffnessLines, StiffnessProblem

# of κ over ln r: separate sliders, and κ that follows the levels less and less
_SMOOTHINGS = 0.0, 3e-5, 3e-4
_NODES = 80  # sliders of a gradual contact: 7 % from one to the next
_RECEPTANCES, _LARGEST_RECEPTANCE = 25, 0.6  # values of R that are tried, in 1/|Z|
_ITERATIONS = 4  # of the errors of the lines
_FIRST_ERROR = 0.05  # of Z, where the iteration starts
_HALF_DECADE = 10**0.5
_ALIKE = 1.05  # of amplitudes: closer ones count as one
_SINGULAR = 1e-7  # smallest singular value of columns of length one
_STIFFEST = 1e10  # of |Z|: a contact that stands for a rigid one
_COMPARED = 3  # levels, at least
_CONTACTS: tuple[Contact, ...] = ("one slider", "gradual", "none")
_SPRING = ("k", "m", "k_3")


@dataclass(frozen=True, eq=False)
class ContactFit(Fit):
    """A contact and an oscillator identified from lines of dynamic stiffness: its problem is a `StiffnessProblem`. Its
    numbers are those of its parameters, with K_z, ρ = K_z^{−1/2} and F_k of the contact that yields at the amplitudes
    seen.

    evidence : ln E, see above.   noise : square of the scale of what it leaves of whole levels, over that of lines.
    """

    evidence: float = 0.0
    noise: float = 1.0

    @property
    def terms(self) -> tuple[str, ...]:
        """Terms of the damping, the contact apart."""
        return tuple(n for n in self.parameters.names if n not in (*_SPRING, *_OF_CONTACT))

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
        return self.all_sliders.K_z - self.sliders.K_z

    @cached_property
    def X_range(self) -> tuple[float, float]:
        """Amplitudes that were seen, m."""
        X = self.problem.mode(self.point).X
        return float(X.min()), float(X.max())

    @cached_property
    def slopes(self) -> dict[str, Array]:
        """Derivatives of the numbers by the unknowns, (p,) each."""
        slopes = dict(zip(self.parameters.keys, np.eye(self.point.size), strict=True))
        if self.problem.contact == "gradual":
            kappa, r = self.problem.kappa, self.all_sliders.r
            own = np.where(kappa, 1.0, 0.0)
            own[kappa] = r < self.X_range[1]
            slopes["K_z"], slopes[FRICTION] = own, own.copy()
            slopes[FRICTION][kappa] *= r
            slopes["rho"] = -0.5 * self.value("rho") ** 3 * own
        elif self.problem.contact == "one slider":
            slopes["K_z"] = -2.0 * self.value("rho") ** -3 * slopes["rho"]
        return slopes

    def value(self, key: str) -> float:
        """Return a number, in its unit; zero where the model does not have it."""
        if key in ("K_z", FRICTION):
            return self.sliders.K_z if key == "K_z" else self.sliders.F_k
        if key in self.parameters:
            return super().value(key)
        return self.sliders.K_z**-0.5 if key == "rho" and self.sliders.K_z else 0.0

    @cached_property
    def hidden(self) -> float:
        """Standard deviation of the stiffness of sliders that slip below a tenth of the smallest amplitude, where they
        show neither stiffness nor loss, N/m: half of those in the half decade above, as sliders of uniform density
        have it."""
        if self.problem.contact != "gradual":
            return 0.0
        near = self.all_sliders.r < _HALF_DECADE * self.problem.nodes[0]
        return 0.5 * float(self.all_sliders.kappa[near].sum())

    def covariance_of(self, *keys: str) -> Array:
        """Return the covariance of some numbers, in their units."""
        nothing = np.zeros(self.point.size)
        by = np.array([self.slopes.get(key, nothing) for key in keys])
        by = by.reshape(len(keys), self.point.size)
        of_K_z = {"K_z": self.hidden, "rho": -0.5 * self.value("rho") ** 3 * self.hidden}
        hidden = np.array([of_K_z.get(key, 0.0) for key in keys])
        return np.asarray(by @ self.covariance @ by.T + np.outer(hidden, hidden))

    def interval(self, key: str) -> tuple[float, float]:
        """Return the 95 % interval of a number, in its unit. The upper end of K_z is infinite where the lines give only
        a lower limit."""
        if key == "K_z" and self.problem.contact == "one slider":
            low, high = self.interval("rho")
            return high**-2, (low**-2 if low > self.parameters["rho"].low else math.inf)
        return super().interval(key)

    def law(self, X: Array, omega: Array | float) -> tuple[Complexes, Complexes]:
        """Return the dynamic stiffness by the law at amplitudes X, m, and angular frequencies, rad/s, and half of the
        intervals of 95 % of its real and its imaginary part, N/m, (n,) each: πX² Im Z is the loss per cycle.

        At ω = 0 the error of the real part is mostly that of k. Lines near a resonance determine k and mω² far less
        well than their difference: at the resonance the interval shows how well the change with X is known.

        Raises ValueError outside of the amplitudes seen.
        """
        low, high = self.X_range
        if not (X.min() >= low * (1.0 - 1e-9) and X.max() <= high * (1.0 + 1e-9)):
            raise ValueError(
                f"the law is fitted to amplitudes from {low:.4g} to {high:.4g} m, got {X.min():.4g} to "
                f"{X.max():.4g} m: keep within them, or measure there"
            )
        ones, level = np.ones((2, X.size)), np.zeros(X.size, dtype=np.intp)
        lines = StiffnessLines(np.broadcast_to(omega, X.shape), X, ones[0] + 0j, level, ("",))
        there = replace(self.problem, lines=lines, sigma=ones)
        values = np.where(np.isin(self.parameters.names, "R"), 0.0, self.point)
        by = there.derivatives(values, self.parameters.free).reshape(2, X.size, -1)
        error = np.sqrt(np.einsum("qni,ij,qnj->qn", by, self.covariance, by))
        reach = special.stdtrit(self.freedom, 0.975) * (error[0] + 1j * error[1])
        return there.law(values), np.asarray(reach)

    @cached_property
    def shown(self) -> tuple[float, float] | None:
        """Where k is given, that of the lines if it is free and the χ² that it saves, with the errors of that fit.

        A gradual contact holds a slider that sticks: with it, only a k that is too large is contradicted.
        """
        if self.parameters["k"].free:
            return None
        free = self.parameters.freed("k")
        free = replace(free, low=np.where(np.array(free.keys) == "k", 0.0, free.low))
        more = _estimated(replace(self.problem, start=free))
        less = replace(more, start=more.start.held("k").moved(k=self.value("k")))
        chi = [np.sum(p.residual(p.ends([p.climbed]).values) ** 2) for p in (less, more)]
        return more.start["k"].value, float(chi[0] - chi[1])

    @one_thread
    def again(self, lines: StiffnessLines, **given: float) -> ContactFit:
        """Return the fit with the same smoothing to other lines.   given : values instead of those that are given."""
        own = self.problem
        problem = replace(
            own,
            lines=lines,
            start=own.start.moved(**given),
            k=given.get("k", own.k),
            nodes=own.nodes * (lines.X.min() / own.lines.X.min()),
        )
        return _fit(_estimated(problem, near=True))


_OF_CONTACT = (FRICTION, "rho", "kappa", "R")


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
    return _fitted(_asked(lines, contact, **options))


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
            f"all lines have nearly the same amplitude, {low:.4g} to {high:.4g} m, and a contact shows only in changes "
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
    nodes = _nodes(lines.X)[: _NODES * (contact == "gradual")]
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
    own_columns = problem.columns(lines)[:, [start.places[name] for name in free]]
    columns = problem.weighted(own_columns, start.values)
    size = np.linalg.norm(columns, axis=0)
    if free and np.linalg.svd(columns / size, compute_uv=False)[-1] < _SINGULAR:
        raise ValueError(
            f"the lines do not separate {', '.join(free)}: add lines at other frequencies or levels, or state "
            "stiffness or mass"
        )
    return problem


def _require_told(name: str, stiffness: float | None) -> None:
    """Raise ValueError for a term that lines cannot determine."""
    of = term(name)
    if of.force is None:
        raise ValueError(f'{FRICTION} belongs to the contact: ask for contact="one slider"')
    if of.linear and of.force(0.0, 1.0, 1.0, 1.0):
        raise ValueError(
            f"{name} acts against the base, whose motion the lines do not contain: use c"
        )
    if stiffness is None and of.force(1.0, 0.0, 2.0, 1.0) != of.force(1.0, 0.0, 1.0, 1.0):
        raise ValueError(f"the force of {name} depends on the spring: state stiffness")


def _nodes(X: Array) -> Array:
    """Return r at which κ of a gradual contact is an unknown, m, from a tenth of the smallest amplitude, at which it is
    felt, to the largest.   X : m, (n,)."""
    return np.geomspace(0.1 * X.min(), X.max(), _NODES + 1)[:-1]


def _estimated(problem: StiffnessProblem, near: bool = False) -> StiffnessProblem:
    """Return the problem with its unknowns where they are likeliest, its errors iterated.   near : whether this is next
    to where it starts."""
    for step in range(_ITERATIONS):
        if step:
            problem = replace(problem, sigma=problem.scatter(problem.start.values))
        starts = [problem.climbed] * (near or step > 0) + ([] if near else _starts(problem))
        problem = replace(problem, start=problem.ends(starts))
        if problem.contact == "gradual" and not near and "R" in problem.start:
            X = problem.mode(problem.start.values).X  # which R has moved
            problem = replace(problem, nodes=_nodes(X))
            problem = replace(problem, start=problem.start.at(problem.solve(problem.start.values)))
    return problem


def _starts(problem: StiffnessProblem) -> list[Parameters]:
    """Return where climbs start: each R, and the best slider with it."""
    most, each = _LARGEST_RECEPTANCE / float(np.abs(problem.lines.Z).max()), [problem.climbed]
    if "R" in problem.start and problem.start["R"].free:
        tried = np.linspace(-most, most, _RECEPTANCES)
        each = [problem.climbed.moved(R=R) for R in tried.tolist()]
    if problem.contact == "one slider":
        each = [one.at(problem.with_slider(one.values)) for one in each]
    if len(each) == 1:
        return each
    chi_square = [float(np.sum(problem.residual(problem.solve(one.values)) ** 2)) for one in each]
    return [each[i] for i in np.argsort(chi_square, kind="stable")[:3]]


def _fitted(problem: StiffnessProblem) -> ContactFit:
    """Return the fit of a problem: the mean over a spring that hardens and one that does not, and that of a gradual
    contact over those of different smoothness."""
    smoothings = _SMOOTHINGS if problem.contact == "gradual" else _SMOOTHINGS[:1]
    starts = {"smoothness": problem.start}
    if "k_3" in problem.start:
        starts = {"smoothness": problem.start.held("k_3"), "k_3": problem.start}
    (_, first), *others = (
        (prior, _fit(_estimated(replace(problem, start=start, smoothing=of))))
        for prior, start in starts.items()
        for of in smoothings
    )
    if not others:
        return first
    candidates = [
        _candidate(f"{prior} {one.problem.smoothing:g}", one, first, prior) for prior, one in others
    ]
    free = np.flatnonzero(problem.start.free)
    weighed = select(first, candidates, [problem.start.keys[i] for i in free])
    values, covariance = first.point.copy(), np.zeros_like(first.covariance)
    values[free], covariance[np.ix_(free, free)] = weighed.values, weighed.covariance
    shares = np.array([one.share for one in weighed.models])
    gains = [one.evidence for one in weighed.models]
    return replace(
        weighed.fit,
        parameters=weighed.fit.parameters.at(values),
        covariance=covariance,
        evidence=first.evidence + float(special.logsumexp(gains, b=shares / shares.sum())),
    )


def _candidate(name: str, fit: ContactFit, plain: ContactFit, prior: str) -> Candidate:
    """Return a fit as a candidate against a plain one."""
    return Candidate(
        name, PRIORS[prior], lambda: fit, evidence=lambda end: end.evidence - plain.evidence
    )


def _fit(problem: StiffnessProblem) -> ContactFit:
    """Return the fit where the unknowns of a problem are. The residual of a wrong contact is similar in all lines of a
    level, so that only the levels count as independent."""
    values, level = problem.start.values, problem.lines.level
    left, unknowns = problem.residual(values), problem.unknowns(values)
    of_levels = np.array([np.bincount(level, part) for part in left.reshape(2, -1)])
    noise = noise_of(float(np.sum(of_levels**2 / np.bincount(level))), of_levels.size)
    noise = 1.0 if problem.contact == "gradual" else noise  # its sliders that hide count
    chi_square = float(left @ left)
    evidence = -float(np.sum(np.log(problem.sigma))) - 0.5 * chi_square
    evidence -= 0.5 * unknowns * math.log(problem.samples)
    freedom = max(problem.samples - unknowns, 1.0)
    covariance = noise * problem.covariance(values)
    own = (problem.start, covariance, chi_square, freedom, problem)
    return ContactFit(*own, evidence=evidence, noise=noise)


@dataclass(frozen=True, eq=False)
class ContactComparison:
    """Contacts compared on lines of dynamic stiffness.

    fits : by name, one slider first.   selection : their weights, and the numbers averaged over them.
    """

    fits: Mapping[str, ContactFit]
    selection: Selection

    @property
    def weights(self) -> dict[str, float]:
        """Weight of each, by name."""
        return dict(zip(self.fits, self.selection.weights, strict=True))

    @property
    def supported(self) -> str:
        """Name of the contact with the largest weight."""
        return max(self.weights, key=self.weights.__getitem__)


@one_thread
def compare_contacts(
    lines: StiffnessLines, *, terms: Sequence[str] = ("c",), **options: Any
) -> ContactComparison:
    """Compare one slider, a gradual contact and no contact, each with further damping, too, by their evidence.

    Use it before taking an answer from stepped lines: its numbers are averages over the contacts that the lines cannot
    distinguish.

    Arguments as for `fit_contact`. Raises ValueError for fewer than three levels.
    """
    if len(lines.names) < _COMPARED:
        raise ValueError(
            f"a comparison of contacts needs {_COMPARED} levels of excitation or more, got {len(lines.names)}: "
            "add levels, or ask for one contact"
        )
    more = [name for name in ("c_2", "c_3") if name not in terms]
    damping = [(*terms, *more[:count]) for count in range(len(more) + 1)]
    fits, priors = dict[str, ContactFit](), dict[str, str]()
    for contact in _CONTACTS:
        for of in damping if contact == "none" else damping[:2]:
            plain = contact != "none" and of == damping[0]
            name = contact if plain else f"{contact} ({', '.join(of)})"
            fits[name] = _fitted(_asked(lines, contact, of, **options))
            own = plain or contact == "none"
            priors[name] = f"{contact} contact" if own else "further damping"
    first, *others = fits
    free = [p for fit in fits.values() for p in fit.terms if fit.parameters[p].free]
    keys = (FRICTION, "rho", *dict.fromkeys(free))
    candidates = [_candidate(of, fits[of], fits[first], priors[of]) for of in others]
    return ContactComparison(fits, select(fits[first], candidates, keys))
