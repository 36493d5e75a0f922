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
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Any

import numpy as np

from ..arguments import shown
from ..arrays import Array, Complexes
from ..model import named_with_unit

Force = Callable[[Any, Any, Any, Any], Any]
"""h, or ∂h/∂ẋ, of (ẋ, ẏ, k, ω), numbers or arrays; m/s, m/s, N/m, rad/s."""

Harmonic = Callable[[Any, Any, Any, Any, Any], Any]
"""g of (ω, X, Y, φ, k) for a harmonic motion, numbers or arrays; rad/s, m, m, rad, N/m."""


@dataclass(frozen=True, slots=True)
class Term:
    """A way to lose energy: one column of the balance, and the coefficient that is identified.

    symbol, unit, words : of the coefficient p, and what it is.   integral, integral_unit : of the factor g.
    force, slope : h and ∂h/∂ẋ; None for friction, whose force has a memory.   harmonic : g of a harmonic motion.
    order : power of the velocity that h grows with: 0 for friction; 1 where the motion under it has a closed form.
    """

    symbol: str
    unit: str
    words: str
    integral: str
    integral_unit: str
    force: Force | None = None
    slope: Force | None = None
    harmonic: Harmonic | None = None
    order: int = 0

    def __reduce__(self) -> tuple[Callable[[str], Term], tuple[str]]:
        """A copy is the term of that key again, as its functions cannot be pickled."""
        return term, (self.symbol,)

    @property
    def linear(self) -> bool:
        """Whether h is linear in ẋ and ẏ, so that the motion under it has a closed form between events."""
        return self.order == 1

    @property
    def column(self) -> str:
        """Column of tables that holds the coefficient, named with its unit: F_k_N, c_N_s_per_m."""
        return named_with_unit(self.symbol, self.unit)

    @property
    def error_column(self) -> str:
        """Column of tables that holds its standard error."""
        return named_with_unit(f"{self.symbol}_standard_error", self.unit)

    @property
    def integral_column(self) -> str:
        """Column of tables that holds the integral: a_m, b_m2_per_s."""
        return named_with_unit(self.integral, self.integral_unit)


KNOWN_TERMS: Mapping[str, Term] = MappingProxyType(
    {
        term.symbol: term
        for term in (
            Term("F_k", "N", "friction force", "a", "m"),
            Term(
                "c",
                "N s/m",
                "viscous damping",
                "b",
                "m²/s",
                force=lambda v, w, k, omega: v,
                slope=lambda v, w, k, omega: np.ones_like(v),
                harmonic=lambda omega, X, Y, phi, k: np.pi * omega * X**2,
                order=1,
            ),
            Term(
                "c_r",
                "N s/m",
                "viscous damping on the velocity relative to the base",
                "b_r",
                "m²/s",
                force=lambda v, w, k, omega: v - w,
                slope=lambda v, w, k, omega: np.ones_like(v),
                harmonic=lambda omega, X, Y, phi, k: np.pi * omega * (X**2 - X * Y * np.cos(phi)),
                order=1,
            ),
            Term(
                "c_2",
                "N s²/m²",
                "quadratic damping",
                "b_2",
                "m³/s²",
                force=lambda v, w, k, omega: np.abs(v) * v,
                slope=lambda v, w, k, omega: 2.0 * np.abs(v),
                harmonic=lambda omega, X, Y, phi, k: 8.0 / 3.0 * omega**2 * X**3,
                order=2,
            ),
            Term(
                "c_3",
                "N s³/m³",
                "cubic damping",
                "b_3",
                "m⁴/s³",
                force=lambda v, w, k, omega: v**3,
                slope=lambda v, w, k, omega: 3.0 * v**2,
                harmonic=lambda omega, X, Y, phi, k: 0.75 * np.pi * omega**3 * X**4,
                order=3,
            ),
            Term(
                "eta",
                "",
                "structural damping",
                "b_eta",
                "J",
                force=lambda v, w, k, omega: k / omega * v,
                slope=lambda v, w, k, omega: k / omega * np.ones_like(v),
                harmonic=lambda omega, X, Y, phi, k: np.pi * k * X**2,
                order=1,
            ),
        )
    }
)
"""Every term that a law can have, by symbol, in the order of columns in tables: to add one is an entry here.

c : force cẋ.   c_r : c_r(ẋ − ẏ).   c_2 : c_2|ẋ|ẋ.   c_3 : c_3ẋ³.   eta : η(k/ω)ẋ, the loss factor of the spring: at
one frequency it cannot be told from c.
"""

FRICTION = "F_k"


def term(key: str) -> Term:
    """The term behind a key: a symbol, or a symbol and the group of records that it belongs to, as in F_k[250 g].

    Raises ValueError for a symbol that is not known.
    """
    symbol, group = parted(key)
    if symbol not in KNOWN_TERMS:
        raise ValueError(f"unknown term {shown(symbol)}; known are {', '.join(KNOWN_TERMS)}")
    found = KNOWN_TERMS[symbol]
    if group is None:
        return found
    return replace(found, symbol=key, integral=of_group(found.integral, group))


def of_group(symbol: str, group: str) -> str:
    """The key of the coefficient that a term has for a group of records: F_k[250 g]."""
    return f"{symbol}[{group}]"


def parted(key: str) -> tuple[str, str | None]:
    """The symbol and the group of a key; None where it belongs to all records."""
    symbol, bracket, group = key.partition("[")
    return symbol, group.removesuffix("]") if bracket else None


def in_order(symbols: Iterable[str]) -> tuple[str, ...]:
    """These terms, each once, in the order of `KNOWN_TERMS`. Raises ValueError for one that is not known."""
    asked = {term(symbol).symbol for symbol in symbols}
    return tuple(symbol for symbol in KNOWN_TERMS if symbol in asked)


def listed(symbols: Sequence[str]) -> str:
    """Symbols as a sentence names them: "F_k", "F_k and c", "F_k, c and c_2". Texts use `project.wording.listed`, which
    stands on a higher floor and does without the libraries that this module imports."""
    return " and ".join([", ".join(symbols[:-1]), symbols[-1]] if len(symbols) > 1 else symbols)


_POINTS = 512  # of a cycle, at least; |ẋ|³ has a jump in its third derivative, and the rule an error of 1e-9
_PER_HARMONIC = 8


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
    """g of a term from the harmonics of r motions x = Re Σ x_n e^{inωt}, y likewise, (r,).

    Terms that are linear in ẋ and ẏ by Parseval's theorem, ∮ẋ² dt = πω Σ n²|x_n|² and ∮ẏẋ dt = πω Σ n² Re x_n y_n*;
    others from the velocity at equidistant phases.

    n : orders, (h,).   x : m, (r, h).   y_n, y : the same of the base, (l,) and (r, l).   omega : rad/s.   k : N/m.
    variance : of the noise in each complex x_n, m², (h,); what it adds to the powers of ẋ in the mean is taken off:
    ẋ² by σ², |ẋ|³ by 3σ²|ẋ|, ẋ⁴ by 6σ²ẋ², σ² = ½ω² Σ n² var x_n.

    Raises ValueError for friction, whose travel no harmonics tell.
    """
    of_term = KNOWN_TERMS[symbol]
    if of_term.force is None:
        raise ValueError(f"{FRICTION} has no integral that harmonics tell")
    variance = np.zeros(n.size) if variance is None else variance
    if of_term.linear:
        square = math.pi * omega * ((np.abs(x) ** 2 - variance) @ n**2)
        factor, of_base = (float(of_term.force(*at, k, omega)) for at in ((1.0, 0.0), (0.0, 1.0)))
        if not of_base:
            return np.asarray(factor * square)
        shared, of_x, of_y = np.intersect1d(n, y_n, assume_unique=True, return_indices=True)
        product = (x[:, of_x] * y[:, of_y].conj()).real @ shared**2
        return np.asarray(factor * square + of_base * math.pi * omega * product)
    points = max(_POINTS, 1 << math.ceil(math.log2(_PER_HARMONIC * float(n.max()))))
    spectrum = np.zeros((len(x), points // 2 + 1), dtype=np.complex128)
    spectrum[:, n.astype(np.intp)] = 0.5j * omega * points * n * x
    v = np.fft.irfft(spectrum, points, axis=1)
    sigma2 = 0.5 * omega**2 * float(variance @ n**2)
    power = of_term.order + 1
    mean = np.mean(of_term.force(v, 0.0, k, omega) * v, axis=1)
    mean -= 0.5 * power * (power - 1) * sigma2 * np.mean(np.abs(v) ** (power - 2), axis=1)
    return np.asarray(2.0 * math.pi / omega * mean)
