"""The terms of a damping law: each a coefficient times a known function of the motion.

    m ẍ + k(x − y) + Σ p_j h_j(ẋ, ẏ) = 0

Over one period of a steady response each takes the energy p_j g_j with

    g_j = ∮ h_j ẋ dt

and the work put in is their sum, Σ g_j p_j = W: Eq. (6) of Liang & Feeny (2010) for any such law. Dry friction is the
term with a memory: its force is that of a contact which sticks and slips, F_k z/Z_m, and its g the travel in slip.

For a harmonic motion x = X cos(ωt − φ) under y = Y cos ωt the integrals have closed forms, given with each term.
Those of any other motion follow from its harmonics (`of_harmonics`).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ..arguments import shown
from ..arrays import Array, Complexes
from ..model import named_with_unit

Force = Callable[[Any, Any, Any, Any], Any]
"""h of (ẋ, ẏ, k, ω), numbers or arrays; m/s, m/s, N/m, rad/s."""


@dataclass(frozen=True, eq=False, repr=False)
class Term(str):
    """A way to lose energy: one column of the balance, and the coefficient p that is identified.

    A term is a string, its symbol, with attributes. It is the key of laws, rows, values and intervals, in which the
    plain symbol finds it, too: values["c_2"]. Its force is p h, where h grows with a fixed power n ≥ 1 of the velocity,

        h(ẋ, ẏ, k, ω) = h_1(k, ω) |ẋ|ⁿ⁻¹ ẋ,    for n = 1 also  h_x(k, ω) ẋ + h_y(k, ω) ẏ

    since the fit scales a response with its level. A force that saturates, or depends on the displacement or the
    history, is no term.

    symbol : of the coefficient.
    force : h, a function of arrays or numbers: ẋ, ẏ (m/s), k (N/m), ω (rad/s); None for friction, which has a memory.
    words : what the term is, for tables.
    unit : of the coefficient, "" for a number.
    integral, integral_unit : symbol and unit of g = ∮ h ẋ dt, for the columns of rows.
    order : n; 0 for friction, 1 where the motion under it has a closed form.
    group : of records, which share the coefficient; None where all do.
    """

    symbol: str
    force: Force | None
    words: str
    unit: str
    integral: str = ""
    integral_unit: str = ""
    order: float = 0
    group: str | None = field(default=None, init=False)

    def __new__(cls, symbol: str, *_: Any, **__: Any) -> Term:
        """Make the text that a term is."""
        return str.__new__(cls, symbol)

    def __reduce__(self) -> tuple[Any, ...]:
        """Make the copy of a term that term itself, as its functions cannot be pickled."""
        return term, (str(self),)

    def of_group(self, group: str) -> Term:
        """Return the coefficient that the term has for a group of records: F_k[250 g]."""
        made = str.__new__(Term, f"{self.symbol}[{group}]")
        made.__dict__.update(self.__dict__, group=group, integral=f"{self.integral}[{group}]")
        return made

    def slope(self, v: Any, w: Any, k: Any, omega: Any) -> Any:
        """Return ∂h/∂ẋ, as h a function of (ẋ, ẏ, k, ω)."""
        assert self.force is not None
        return self.force(1.0, 0.0, k, omega) * self.order * np.abs(v) ** (self.order - 1)

    def harmonic(self, omega: Any, X: Any, Y: Any, phi: Any, k: Any) -> Any:
        """Return g of a harmonic motion, numbers or arrays; rad/s, m, m, rad, N/m."""
        assert self.force is not None
        n, of_mass = self.order, self.force(1.0, 0.0, k, omega)
        to_base = self.force(0.0, 1.0, k, omega) / of_mass if self.linear else 0.0
        moved = X ** (n + 1) + to_base * X * Y * np.cos(phi)
        return _cycle_integral(n) * (omega**n * of_mass) * moved

    @property
    def linear(self) -> bool:
        """Whether h is linear in ẋ and ẏ, so that the motion under it has a closed form between events."""
        return self.order == 1

    @property
    def column(self) -> str:
        """Column of tables that holds the coefficient, named with its unit: F_k_N, c_N_s_per_m."""
        return named_with_unit(str(self), self.unit)

    @property
    def error_column(self) -> str:
        """Column of tables that holds its standard error."""
        return named_with_unit(f"{self}_standard_error", self.unit)

    @property
    def integral_column(self) -> str:
        """Column of tables that holds the integral: a_m, b_m2_per_s."""
        return named_with_unit(self.integral, self.integral_unit)


def _cycle_integral(order: float) -> float:
    """Return ∮ |cos θ|ⁿ⁺¹ dθ over a cycle, n : order."""
    if order >= 2.0:
        return order / (order + 1.0) * _cycle_integral(order - 2.0)
    if order in (0.0, 1.0):
        return math.pi if order else 4.0
    return 2.0 * math.sqrt(math.pi) * math.gamma(0.5 * order + 1.0) / math.gamma(0.5 * order + 1.5)


_TO_BASE = "viscous damping on the velocity relative to the base"

KNOWN_TERMS: dict[str, Term] = {
    term.symbol: term
    for term in (
        Term("F_k", None, "friction force", "N", "a", "m"),
        Term("c", lambda v, w, k, omega: v, "viscous damping", "N s/m", "b", "m²/s", 1),
        Term("c_r", lambda v, w, k, omega: v - w, _TO_BASE, "N s/m", "b_r", "m²/s", 1),
        Term(
            "c_2",
            lambda v, w, k, omega: abs(v) * v,
            "quadratic damping",
            "N s²/m²",
            "b_2",
            "m³/s²",
            2,
        ),
        Term(
            "c_3", lambda v, w, k, omega: v * v * v, "cubic damping", "N s³/m³", "b_3", "m⁴/s³", 3
        ),
        Term(
            "eta", lambda v, w, k, omega: k / omega * v, "structural damping", "", "b_eta", "J", 1
        ),
    )
}
"""The terms by symbol, in the order of columns in tables: to add one is an entry here.

c : force cẋ.   c_r : c_r(ẋ − ẏ).   c_2 : c_2|ẋ|ẋ.   c_3 : c_3ẋ³.   eta : η(k/ω)ẋ, the loss factor of the spring: at
one frequency it cannot be distinguished from c.
"""

FRICTION = "F_k"


def term(key: str) -> Term:
    """Return the term behind a key: the key itself where it is a term; else the one of that symbol, or of that symbol
    and the group of records that it belongs to, F_k[250 g].

    Raises ValueError for a symbol that is not known.
    """
    if isinstance(key, Term):
        return key
    symbol, bracket, group = key.partition("[")
    if symbol not in KNOWN_TERMS:
        raise ValueError(f"unknown term {shown(symbol)}; known are {', '.join(KNOWN_TERMS)}")
    known = KNOWN_TERMS[symbol]
    return known.of_group(group.removesuffix("]")) if bracket else known


def in_order(symbols: Iterable[str]) -> tuple[Term, ...]:
    """Return these terms, each once, in the order of `KNOWN_TERMS`. Raises ValueError for one that is not known."""
    asked = set(map(term, symbols))
    return tuple(one for one in KNOWN_TERMS.values() if one in asked)


def symbols_in_words(symbols: Sequence[str]) -> str:
    """Return symbols as a sentence names them: "F_k", "F_k and c", "F_k, c and c_2". Texts use
    `project.wording.listed`, which stands on a higher floor and does without the libraries that this module imports."""
    return " and ".join([", ".join(symbols[:-1]), symbols[-1]] if len(symbols) > 1 else symbols)


def of_harmonics(
    symbol: str,
    n: Array,
    x: Complexes,
    y_n: Array,
    y: Complexes,
    omega: float,
    k: float,
    variance: Array | None = None,
) -> Array:
    """Return g of a term from the harmonics of r motions x = Re Σ x_n e^{inωt}, y likewise, (r,).

    Terms that are linear in ẋ and ẏ by Parseval's theorem, ∮ẋ² dt = πω Σ n²|x_n|² and ∮ẏẋ dt = πω Σ n² Re x_n y_n*;
    others from the velocity at equidistant phases.

    n : orders, (h,).   x : m, (r, h).   y_n, y : the same of the base, (l,) and (r, l).   omega : rad/s.   k : N/m.
    variance : of the noise in each complex x_n, m², (r, h); what it adds to the powers of ẋ in the mean is taken off:
    ẋ² by σ², |ẋ|³ by 3σ²|ẋ|, ẋ⁴ by 6σ²ẋ², σ² = ½ω² Σ n² var x_n.

    Raises ValueError for friction, whose travel harmonics do not determine.
    """
    of_term = term(symbol)
    if of_term.force is None:
        raise ValueError(f"{FRICTION} has no integral that follows from harmonics")
    variance = np.zeros((1, n.size)) if variance is None else variance
    if of_term.linear:
        square = math.pi * omega * ((np.abs(x) ** 2 - variance) @ n**2)
        factor, of_base = (float(of_term.force(*at, k, omega)) for at in ((1.0, 0.0), (0.0, 1.0)))
        if not of_base:
            return np.asarray(factor * square)
        shared, of_x, of_y = np.intersect1d(n, y_n, assume_unique=True, return_indices=True)
        product = (x[:, of_x] * y[:, of_y].conj()).real @ shared**2
        return np.asarray(factor * square + of_base * math.pi * omega * product)
    # |ẋ|³ has a jump in its third derivative: with 512 points, eight for each harmonic, the rule errs by 1e-9
    points = max(512, 1 << math.ceil(math.log2(8 * float(n.max()))))
    spectrum = np.zeros((len(x), points // 2 + 1), dtype=np.complex128)
    spectrum[:, n.astype(np.intp)] = 0.5j * omega * points * n * x
    v = np.fft.irfft(spectrum, points, axis=1)
    sigma2 = 0.5 * omega**2 * (variance @ n**2)
    power = of_term.order + 1
    mean = np.mean(of_term.force(v, 0.0, k, omega) * v, axis=1)
    bias = 0.5 * power * (power - 1) * sigma2 * np.mean(np.abs(v) ** (power - 2), axis=1)
    mean -= bias * float(of_term.force(1.0, 0.0, k, omega))
    return np.asarray(2.0 * math.pi / omega * mean)
