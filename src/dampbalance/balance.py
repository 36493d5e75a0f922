"""Rows of the energy balance from features, one function per approach.

Over one period of a steady response the work put in through the base is lost to friction and to the damper:

    a F_k + b c = W                                                                            (6)

Every approach of Liang & Feeny (2010) is this one equation; they differ only in how a, b and W are obtained. Each
function below takes the features of responses, of any shape, and returns a row for each. The harmonic approaches
put x = X cos(ωt − φ) into the integrals and so share b and W; they differ in how they see the onset of slip, which
limits the friction travel a: by its displacement X_s, by its time t_s or by its velocity V_s. A rigid contact is the
limit X_s → −X, t_s → 0, V_s → 0 of each: a = 4X.

The Fourier balance, which is not in the paper, assumes no shape of x(t): of a harmonic base's work it is the
fundamental alone that counts, exactly, and the odd harmonics make up the viscous integral. It holds off resonance.

A row is NaN where its response lacks a feature (nothing slips). The solver of `solver.py` leaves such rows out.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from .arguments import names, shown
from .arrays import Array, Mask
from .law.law import Law
from .law.terms import KNOWN_TERMS, Term, in_order, term

if TYPE_CHECKING:
    from .features import Features


TERMS: dict[str, Term] = {symbol: KNOWN_TERMS[symbol] for symbol in ("F_k", "c")}
"""The terms of the balance (6), by symbol, in the order of columns in tables; laws may have others of KNOWN_TERMS."""


@dataclass(frozen=True, eq=False, slots=True)
class Rows:
    """Rows Σ g_j p_j = W of the energy balance, one per response; the unknowns p_j are the coefficients of TERMS.

    The first axis counts the rows that are solved together; further axes count cases.

    terms : symbol of p_j → g_j, its integral over a period, in m for F_k (a) and m²/s for c (b).   W : input work, J.
    weights : of the squares of the rows' misfits, 1/J²; None weighs all alike, as (9).
    covariance : of the errors of (g_1 … g_p, W), in the order of the terms, (p + 1, p + 1, L, …); where it is given,
    rows are weighted by inverse variance, see `weighted`.
    given : symbol → value of the coefficients that are known and not to be identified.

    Raises ValueError for a given coefficient that is no term of the rows.
    """

    terms: Mapping[str, Array]
    W: Array
    weights: Array | None = None
    covariance: Array | None = None
    given: Mapping[str, float] = field(default_factory=dict)

    def __post_init__(self) -> None:
        unknown = sorted(set(self.given) - set(self.terms))
        if unknown:
            raise ValueError(f"given {unknown} are no terms of these rows: {list(self.terms)}")

    def __getitem__(self, index: Any) -> Rows:
        """Return the rows at `index`, an index of arrays: [[1, 0]] is two rows in that order, [:, 0] those of a
        case."""
        return replace(
            self,
            terms={symbol: integral[index] for symbol, integral in self.terms.items()},
            W=self.W[index],
            weights=None if self.weights is None else self.weights[index],
            covariance=None
            if self.covariance is None
            else self.covariance[:, :, *(index if isinstance(index, tuple) else (index,))],
        )

    @property
    def usable(self) -> Mask:
        """Mask of the rows that can enter an estimate: all their numbers are finite."""
        finite = [np.isfinite(array) for array in (*self.terms.values(), self.W)]
        usable: Mask = np.logical_and.reduce(finite)
        return usable

    def misfit(self, coefficients: Mapping[str, ArrayLike]) -> Array:
        """Return Σ g_j p_j − W, J, for these coefficients, by symbol."""
        work = sum(np.asarray(p) * self.terms[symbol] for symbol, p in coefficients.items())
        return np.asarray(work - self.W)

    def of_law(self, law: Law) -> Rows:
        """Return the rows with a column for each coefficient of the law: where a term has groups, one for each of them,
        zero in the rows of the others; its given coefficients are known."""
        columns: dict[str, Array] = {}
        for key in law.keys:
            columns[key] = integral = self.terms[key.symbol]
            if key.group is not None:
                member = np.array([label == key.group for label in law.groups[key.symbol]])
                member = member.reshape(-1, *[1] * (integral.ndim - 1))
                columns[key] = np.where(member, integral, 0.0)
        return replace(self, terms=columns, given={**self.given, **law.given})

    def scatter(self) -> Array:
        """Return the covariance of (g_1 … g_p, W) over the last axis, that of replicates of the rows: (p + 1, p + 1, L,
        …)."""
        parts = np.stack([*self.terms.values(), self.W])
        parts = parts - parts.mean(axis=-1, keepdims=True)
        covariance: Array = np.einsum("i...r,j...r->ij...", parts, parts) / (parts.shape[-1] - 1)
        return covariance

    def weighted(self, coefficients: Mapping[str, ArrayLike]) -> Rows:
        """Return the rows with the weights that their covariance gives them, 1/var(Σ g_j p_j − W), p_j :
        `coefficients`.

        Raises ValueError where there is no covariance.
        """
        if self.covariance is None:
            raise ValueError("rows without a covariance have no weights: give their covariance")
        known = {**self.given, **coefficients}
        p = [np.asarray(known[symbol]) for symbol in self.terms] + [np.asarray(-1.0)]
        variance = sum(
            one * other * self.covariance[i, j]
            for i, one in enumerate(p)
            for j, other in enumerate(p)
        )
        with np.errstate(divide="ignore", invalid="ignore"):
            return replace(self, weights=1.0 / np.asarray(variance), covariance=None)


def direct(features: Features, k: ArrayLike) -> Rows:
    """Return rows of the direct integration: nothing is assumed of the shape of x(t).

        a = 2 ∫ |ẋ| dt, t_s … t_2      (7a, whose lower limit is printed t_i)
        b = ∫ ẋ² dt, W = ∫ k y ẋ dt    (7b), (5), both over the period from t_1

    features : a (m), b (m²/s), W (J) integrated from the records.   k : not used again; W holds it already.
    """
    return Rows({"F_k": features.a, "c": features.b}, features.W)


def slip_displacement(features: Features, k: ArrayLike) -> Rows:
    """Return rows of the harmonic-response-X_s approach: a = 2(X − X_s), with (13) and (14).

    features : X, X_s (m, X_s < 0), Y (m), phi (rad), omega (rad/s).   k : stiffness, N/m.
    """
    return _harmonic(features, k, a=2.0 * (features.X - features.X_s))


def slip_time(features: Features, k: ArrayLike) -> Rows:
    """Return rows of the harmonic-response-t_s approach: a = 2X(1 + cos ωt_s), with (11) and (14).

    t_s counts from the velocity reversal at x = −X, as in (17) and (18). In (11) it is an absolute time:
    −cos(ωt_s − φ) there is +cos ωt_s here, because the reversal is at ωt = φ + π.

    features : X (m), t_s (s), Y (m), phi (rad), omega (rad/s).   k : stiffness, N/m.
    """
    return _harmonic(
        features, k, a=2.0 * features.X * (1.0 + np.cos(features.omega * features.t_s))
    )


def slip_velocity(features: Features, k: ArrayLike) -> Rows:
    """Return rows of the harmonic-response-V_s approach: a = 2X(1 + √((ωX)² − V_s²)/(ωX)), with (12) and (14).

    A V_s above ωX has no place in a harmonic motion of amplitude X: such a row is NaN.

    features : X (m), V_s (m/s), Y (m), phi (rad), omega (rad/s).   k : stiffness, N/m.
    """
    return _harmonic(features, k, a=_travel_from_velocity(features, sign=-1.0))


def slip_velocity_as_printed(features: Features, k: ArrayLike) -> Rows:
    """Return rows behind the V_s columns of the paper's Table 3, which hold a slip of sign: not an approach to use.

    The paper defines α = ωX + √((ωX)² − V_s²) with (19); the printed columns come out, to the last digit, with a plus
    under the root. It makes a larger than 4X, farther than a body between ±X can slide. The error lowers F_k, by chance
    towards the true value. The V_s least squares of the paper's text use the minus.
    """
    return _harmonic(features, k, a=_travel_from_velocity(features, sign=+1.0))


def fourier(features: Features, k: ArrayLike) -> Rows:
    """Return rows of the Fourier balance: no shape of x(t) is assumed, but that the base moves as y = Y cos ωt.

        a = 2(X − X_s)                    as the X_s approach: ẋ keeps its sign from slip onset to reversal, so (7a)
                                          telescopes, exactly, for two reversals and one onset per half cycle
        b = πω Σ n² X_n², n = 1, 3, 5     (7b) by Parseval's theorem, cut after the fifth harmonic
        W = πkY X_1 sin φ_1               (5) by orthogonality, exactly: the other harmonics do no net work against y

    x = Σ X_n cos(nωt − φ_n). Even harmonics are absent from a symmetric response. What is cut
    off makes b too small, by 1.2e-4 (relative) or less for the paper's responses, and F_k too large, by 5e-4 or less.

    features : X, X_s, X_1, X_3, X_5, Y (m), phi_fundamental (rad), omega (rad/s).   k : stiffness, N/m.
    """
    a = 2.0 * (features.X - features.X_s)
    b = viscous_integral(features.omega, {1: features.X_1, 3: features.X_3, 5: features.X_5})
    W = np.pi * np.asarray(k) * features.Y * features.X_1 * np.sin(features.phi_fundamental)
    return Rows({"F_k": a, "c": b}, W)


def viscous_integral(omega: ArrayLike, harmonics: Mapping[int, Array]) -> Array:
    """Return b = ∮ ẋ² dt = πω Σ n² X_n² of x = Σ X_n cos(nωt − φ_n), m²/s: (7b) by Parseval's theorem.

    omega : ω, rad/s.   harmonics : n → X_n, m, each of shape (n,).
    """
    total = sum(n**2 * X_n**2 for n, X_n in harmonics.items())
    integral: Array = np.asarray(np.pi * np.asarray(omega) * total)
    return integral


@dataclass(frozen=True, eq=False, repr=False)
class Approach(str):
    """A way to obtain the rows of the balance, and what figures, tables and reports need to know of it.

    An approach is the text of its name and knows more of it. It is the key of answers, fits and tables, where its name
    alone finds it, too. It gives no estimate of a law with a term of which it has no form.

    name : a name of letters, digits and "_".
    rows : function of `features.Features` and the stiffness k, N/m, that returns `Rows`. It must work element by
    element on features of any shape, (levels,) or (levels, cases), and give NaN where a feature does not exist.
    label : its name in words or as a symbol; default, its name.
    takes_phase : whether it depends on a choice of the phase φ, and on a φ and a t_s common to all levels; studies then
    try each definition of the phase.
    terms : of the coefficients that it identifies unless a law asks for others; its rows are for these.
    integral : the function from features, the stiffness k and a term to its g, for those others; None where it has no
    form of them.
    """

    name: str
    rows: Callable[[Features, ArrayLike], Rows]
    label: str = ""
    takes_phase: bool = False
    terms: Sequence[str] = ("F_k", "c")  # those of (6)
    integral: Callable[[Features, ArrayLike, str], Array] | None = None

    def __new__(cls, name: str, *_: Any, **__: Any) -> Approach:
        """Make the text that an approach is."""
        return str.__new__(cls, name)

    def __post_init__(self) -> None:
        self.__dict__.update(label=self.label or self.name, terms=in_order(self.terms))

    def __reduce__(self) -> tuple[Any, ...]:
        """Make the copy of an approach of the package that approach itself."""
        if APPROACHES.get(self) is self:
            return approach, (self.name,)
        return Approach, tuple(self.__dict__.values())

    def __call__(
        self, features: Features, k: ArrayLike, terms: Sequence[str] | str | None = None
    ) -> Rows:
        """Return the rows that this approach obtains from `features`, with the stiffness k, N/m.

        terms : default, its own. Where it knows no form of a term, its column is NaN.
        """
        rows = self.rows(features, k)
        if terms is None:
            return rows
        columns = {
            symbol: rows.terms[symbol]
            if symbol in rows.terms
            else np.full(features.X.shape, np.nan)
            if self.integral is None
            else self.integral(features, k, symbol)
            for symbol in names("terms", terms)
        }
        return replace(rows, terms=columns)


def _integrated(features: Features, k: ArrayLike, symbol: str) -> Array:
    """Return g of a term as it was integrated from the records; NaN where it was not."""
    return features.integrals.get(symbol, np.full(features.W.shape, np.nan))


def _of_harmonic_motion(features: Features, k: ArrayLike, symbol: str) -> Array:
    """Return g of a term for x = X cos(ωt − φ)."""
    f = features
    return np.asarray(term(symbol).harmonic(f.omega, f.X, f.Y, f.phi, np.asarray(k)))


def _of_three_harmonics(features: Features, k: ArrayLike, symbol: str) -> Array:
    """Return g of a term that the amplitudes of three harmonics determine: structural damping, and the relative
    velocity."""
    b = viscous_integral(features.omega, {1: features.X_1, 3: features.X_3, 5: features.X_5})
    if symbol == "eta":
        return np.asarray(np.asarray(k) / features.omega * b)
    if symbol == "c_r":
        shared = features.Y * features.X_1 * np.cos(features.phi_fundamental)
        return np.asarray(b - np.pi * features.omega * shared)
    return np.full(np.shape(b), np.nan)


APPROACHES: dict[str, Approach] = {
    approach.name: approach
    for approach in (
        Approach("direct", direct, "direct integration", integral=_integrated),
        Approach("X_s", slip_displacement, takes_phase=True, integral=_of_harmonic_motion),
        Approach("t_s", slip_time, takes_phase=True, integral=_of_harmonic_motion),
        Approach("V_s", slip_velocity, takes_phase=True, integral=_of_harmonic_motion),
        Approach("fourier", fourier, "Fourier", integral=_of_three_harmonics),
    )
}
"""The built-in approaches by the name that configurations and tables know them by: to add one is a function and an
entry here."""


def approach(name: str) -> Approach:
    """Return the approach behind a name: the name itself where it is an approach; else that of the package.

    Raises ValueError for a name that is not known.
    """
    if isinstance(name, Approach):
        return name
    if name not in APPROACHES:
        raise ValueError(f"unknown approach {shown(name)}; known are {', '.join(APPROACHES)}")
    return APPROACHES[name]


def takes_phase(name: str) -> bool:
    """Return whether estimates by an approach, or the built-in one of that name, depend on a choice of the phase φ."""
    known = name if isinstance(name, Approach) else APPROACHES.get(name)
    return known is None or known.takes_phase


def _harmonic(features: Features, k: ArrayLike, a: Array) -> Rows:
    """Return the friction travel a, with the viscous integral b = πωX² of (11)–(13) and the input work W = πkYX sin φ
    of (14)."""
    X = features.X
    b = np.pi * features.omega * X**2
    W = np.pi * np.asarray(k) * features.Y * X * np.sin(features.phi)
    return Rows({"F_k": a, "c": b}, W)


def _travel_from_velocity(features: Features, sign: float) -> Array:
    """Return a = 2X(1 + √(1 ± (V_s/ωX)²)): with the minus, cos ωt_s written in terms of V_s = ωX sin ωt_s."""
    X = features.X
    with np.errstate(invalid="ignore"):  # V_s > ωX: NaN, as documented
        cosine = np.sqrt(1.0 + sign * (features.V_s / (features.omega * X)) ** 2)
    travel: Array = 2.0 * X * (1.0 + cosine)
    return travel
