"""Rows of the energy balance from features, one function per approach.

Over one period of a steady response the work put in through the base is lost to friction and to the damper:

    a F_k + b c = W                                                                            (6)

All approaches of Liang & Feeny (2010) use this equation and differ only in how they obtain a, b and W. Each function
below takes the features of responses, of any shape, and returns a row for each. The harmonic approaches put
x = X cos(ωt − φ) into the integrals and so share b and W. They differ in the feature of the slip onset from which they
compute the friction travel a: its displacement X_s, its time t_s or its velocity V_s. A rigid contact is the limit
X_s → −X, t_s → 0, V_s → 0 of each: a = 4X.

The Fourier balance, which is not in the paper, assumes no shape of x(t). Only the fundamental does net work against a
harmonic base, exactly, and the odd harmonics add up to the viscous integral. It holds off resonance.

A row is NaN where its response lacks a feature (nothing slips); `solver.py` leaves such rows out.
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
    """Rows Σ g_j p_j = W of the energy balance, one per response; the p_j are the coefficients to be identified.

    An approach returns them, and `solver.solve` solves them. The first axis counts the rows that are solved together,
    further axes count cases.

    terms : symbol of p_j → g_j, its integral over a period, in m for F_k (a) and m²/s for c (b).   W : input work, J.
    weights : of the squared misfits of the rows, 1/J²; default, equal weights, as in (9).
    covariance : of the errors of (g_1 … g_p, W), in the order of the terms, (p + 1, p + 1, L, …); if it is given, rows
    are weighted by inverse variance, see `weighted`.
    given : symbol → value of coefficients that are known and not to be identified.

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
        """Return the rows at `index`, as in NumPy: [[1, 0]] selects two rows in that order, [:, 0] those of a case."""
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
        """Mask of the rows whose numbers are all finite, which can enter an estimate."""
        finite = [np.isfinite(array) for array in (*self.terms.values(), self.W)]
        usable: Mask = np.logical_and.reduce(finite)
        return usable

    def misfit(self, coefficients: Mapping[str, ArrayLike]) -> Array:
        """Return the misfit Σ g_j p_j − W, J.   coefficients : symbol → p_j."""
        work = sum(np.asarray(p) * self.terms[symbol] for symbol, p in coefficients.items())
        return np.asarray(work - self.W)

    def of_law(self, law: Law) -> Rows:
        """Return the rows with a column for each coefficient of a law, and its given coefficients.

        A term with groups has a column for each group, which is zero in the rows of the other groups."""
        columns: dict[str, Array] = {}
        for key in law.keys:
            columns[key] = integral = self.terms[key.symbol]
            if key.group is not None:
                member = np.array([label == key.group for label in law.groups[key.symbol]])
                member = member.reshape(-1, *[1] * (integral.ndim - 1))
                columns[key] = np.where(member, integral, 0.0)
        return replace(self, terms=columns, given={**self.given, **law.given})

    def scatter(self) -> Array:
        """Return the covariance of (g_1 … g_p, W) over replicates, which the last axis counts: (p + 1, p + 1, L, …)."""
        parts = np.stack([*self.terms.values(), self.W])
        parts = parts - parts.mean(axis=-1, keepdims=True)
        covariance: Array = np.einsum("i...r,j...r->ij...", parts, parts) / (parts.shape[-1] - 1)
        return covariance

    def weighted(self, coefficients: Mapping[str, ArrayLike]) -> Rows:
        """Return the rows weighted by inverse variance, 1/var(Σ g_j p_j − W), from their covariance.

        coefficients : symbol → p_j. Raises ValueError for rows without a covariance.
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
    """Return rows by direct integration, which assumes nothing about the shape of x(t).

        a = 2 ∫ |ẋ| dt, t_s … t_2      (7a, whose lower limit is printed t_i)
        b = ∫ ẋ² dt, W = ∫ k y ẋ dt    (7b), (5), both over the period from t_1

    features : a (m), b (m²/s), W (J) integrated from the records.   k : not used, as W contains it.
    """
    return Rows({"F_k": features.a, "c": features.b}, features.W)


def slip_displacement(features: Features, k: ArrayLike) -> Rows:
    """Return rows by the harmonic-response-X_s approach, a = 2(X − X_s), with (13) and (14).

    features : X, X_s (m, X_s < 0), Y (m), phi (rad), omega (rad/s).   k : stiffness, N/m.
    """
    return _harmonic(features, k, a=2.0 * (features.X - features.X_s))


def slip_time(features: Features, k: ArrayLike) -> Rows:
    """Return rows by the harmonic-response-t_s approach, a = 2X(1 + cos ωt_s), with (11) and (14).

    t_s counts from the velocity reversal at x = −X, as in (17) and (18). In (11) it is an absolute time:
    −cos(ωt_s − φ) there is +cos ωt_s here, because the reversal is at ωt = φ + π.

    features : X (m), t_s (s), Y (m), phi (rad), omega (rad/s).   k : stiffness, N/m.
    """
    return _harmonic(
        features, k, a=2.0 * features.X * (1.0 + np.cos(features.omega * features.t_s))
    )


def slip_velocity(features: Features, k: ArrayLike) -> Rows:
    """Return rows by the harmonic-response-V_s approach, a = 2X(1 + √((ωX)² − V_s²)/(ωX)), with (12) and (14).

    A row with V_s > ωX, which no harmonic motion of amplitude X reaches, is NaN.

    features : X (m), V_s (m/s), Y (m), phi (rad), omega (rad/s).   k : stiffness, N/m.
    """
    return _harmonic(features, k, a=_travel_from_velocity(features, sign=-1.0))


def slip_velocity_as_printed(features: Features, k: ArrayLike) -> Rows:
    """Return the rows behind the V_s columns of the paper's Table 3, with their error of sign; do not use them to
    identify.

    The paper defines α = ωX + √((ωX)² − V_s²) with (19); a plus under the root reproduces the printed columns to the
    last digit. It makes a larger than 4X, the longest travel between ±X. The error lowers F_k, by chance towards the
    true value. The V_s least squares of the paper's text use the minus.
    """
    return _harmonic(features, k, a=_travel_from_velocity(features, sign=+1.0))


def fourier(features: Features, k: ArrayLike) -> Rows:
    """Return rows by the Fourier balance, which assumes a harmonic base, y = Y cos ωt, and nothing about x(t).

        a = 2(X − X_s)                    as the X_s approach: ẋ keeps its sign from slip onset to reversal, so (7a)
                                          telescopes, exactly, for two reversals and one onset per half cycle
        b = πω Σ n² X_n², n = 1, 3, 5     (7b) by Parseval's theorem, cut after the fifth harmonic
        W = πkY X_1 sin φ_1               (5) by orthogonality, exactly: the other harmonics do no net work against y

    x = Σ X_n cos(nωt − φ_n); a symmetric response has no even harmonics. Without harmonics beyond the fifth b is too
    small, by a relative 1.2e-4 or less for the paper's responses, and F_k too large, by 5e-4 or less.

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
    """A way to obtain the rows of the balance, with its label and its needs for figures, tables and reports.

    An approach is a text, its name, and so a key of answers, fits and tables that the name alone finds, too. It gives
    no estimate for a law with a term for which it has no `integral`.

    name : a name of letters, digits and "_".
    rows : function of `features.Features` and the stiffness k, N/m, that returns `Rows`. It must work element by
    element on features of any shape, (levels,) or (levels, cases), and give NaN where a feature does not exist.
    label : its name in words or as a symbol; default, its name.
    takes_phase : whether it depends on the definition of the phase φ, and on whether φ and t_s are common to all
    levels; studies then try each of them.
    terms : of the coefficients that it identifies by default; its `rows` are for these.
    integral : function from features, the stiffness k and the symbol of another term to its g; default, none.
    """

    name: str
    rows: Callable[[Features, ArrayLike], Rows]
    label: str = ""
    takes_phase: bool = False
    terms: Sequence[str] = ("F_k", "c")  # those of (6)
    integral: Callable[[Features, ArrayLike, str], Array] | None = None

    def __new__(cls, name: str, *_: Any, **__: Any) -> Approach:
        """Return the approach as the text of its name."""
        return str.__new__(cls, name)

    def __post_init__(self) -> None:
        self.__dict__.update(label=self.label or self.name, terms=in_order(self.terms))

    def __call__(
        self, features: Features, k: ArrayLike, terms: Sequence[str] | str | None = None
    ) -> Rows:
        """Return the rows that this approach forms from `features`, with the stiffness k, N/m.

        terms : default, its own. The column of a term that it cannot integrate is NaN.
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
    """Return g of a term as integrated from the records; NaN where it was not."""
    return features.integrals.get(symbol, np.full(features.W.shape, np.nan))


def _of_harmonic_motion(features: Features, k: ArrayLike, symbol: str) -> Array:
    """Return g of a term for x = X cos(ωt − φ)."""
    f = features
    return np.asarray(term(symbol).harmonic(f.omega, f.X, f.Y, f.phi, np.asarray(k)))


def _of_three_harmonics(features: Features, k: ArrayLike, symbol: str) -> Array:
    """Return g of a term that the amplitudes of three harmonics determine: structural damping or relative velocity."""
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
"""The built-in approaches by their names in configurations and tables; a new one is a function and an entry here."""


def approach(name: str) -> Approach:
    """Return the approach of a name, or the argument itself if it is an approach.

    Raises ValueError for an unknown name.
    """
    if isinstance(name, Approach):
        return name
    if name not in APPROACHES:
        raise ValueError(f"unknown approach {shown(name)}; known are {', '.join(APPROACHES)}")
    return APPROACHES[name]


def takes_phase(name: str) -> bool:
    """Return whether estimates by an approach, or the built-in one of that name, depend on the definition of φ."""
    known = name if isinstance(name, Approach) else APPROACHES.get(name)
    return known is None or known.takes_phase


def _harmonic(features: Features, k: ArrayLike, a: Array) -> Rows:
    """Return rows of the friction travel a with b = πωX² of (11)–(13) and W = πkYX sin φ of (14)."""
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
