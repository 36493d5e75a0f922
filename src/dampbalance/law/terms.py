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
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ..arguments import shown, text
from ..arrays import Array, Complexes
from ..model import named_with_unit

Force = Callable[[Any, Any, Any, Any], Any]
"""h of (ẋ, ẏ, k, ω), numbers or arrays; m/s, m/s, N/m, rad/s."""


NAME = "[A-Za-z][A-Za-z0-9_]{0,39}"
SYMBOL_IN_WORDS = 'a name of letters, digits and "_"'


@dataclass(frozen=True, eq=False, repr=False)
class Term(str):
    """A way to lose energy: one column of the balance, and the coefficient p that is identified.

    A term is the text of its symbol and knows more of it. It is the key of laws, rows, values and intervals, where the
    symbol alone finds it, too: values["c_4"]. The built-in terms, `KNOWN_TERMS`, are named by their symbols; one of
    your own is passed as an object, wherever terms have names:

        quartic = Term("c_4", lambda v, w, k, omega: abs(v) ** 3 * v, words="quartic damping")
        identify(records, k, terms=["F_k", "c", quartic])

    `laws=True` tries it, too, where it is among the terms; a study takes it as a term of the balance and as a
    parameter; `motion.law_response.law_response` computes the response under it, {quartic: 20000.0}. Its force is p h,
    in which h grows with a fixed power n ≥ 1 of the velocity,

        h(ẋ, ẏ, k, ω) = h_1(k, ω) |ẋ|ⁿ⁻¹ ẋ,    for n = 1 also  h_x(k, ω) ẋ + h_y(k, ω) ẏ

    since the fit scales a response with its level; g = ∮ h ẋ dt, ∂h/∂ẋ and n follow from h. A force that saturates, or
    depends on the displacement or the history, is no term. Free decays determine F_k, c, c_2 and c_3 alone, and the
    Fourier approach, which has three harmonics only, gives no estimate of it.

    symbol : of the coefficient, a name of letters, digits and "_".
    force : h, a function of arrays or numbers: ẋ, ẏ (m/s), k (N/m), ω (rad/s); None for friction, which has a memory.
    words : what the term is, for tables; default, its power.
    unit : of the coefficient, "" for a number; default, by the power, "N s⁴/m⁴"; needed where h depends on k or ω.
    integral, integral_unit : symbol and unit of g, for the columns of rows; default, b_ and the symbol, by the power.
    order : n, found from the force; 0 for friction, 1 where the motion under it has a closed form.
    group : of records, which share the coefficient; None where all do.

    Raises ValueError for a symbol that is no name, a function that fails or returns another shape, and a force that is
    not of this kind.

    >>> import math
    >>> from dampbalance import BaseMotion, Oscillator, Term, identify, measured_orbit
    >>> from dampbalance.motion.law_response import law_response
    >>> c_4 = Term("c_4", lambda v, w, k, omega: abs(v) ** 3 * v, words="quartic damping")
    >>> c_4.unit, c_4.integral_column
    ('N s⁴/m⁴', 'b_c_4_m5_per_s4')
    >>> osc = Oscillator(m=2.42, c=0.0, k=2310.0, K_z=208000.0, F_k=1.28)
    >>> records = []
    >>> for Y in (0.004, 0.012):
    ...     orbit = law_response(osc, BaseMotion(Y=Y, omega=2 * math.pi * 4.92), {c_4: 20000.0})
    ...     records.append(measured_orbit(orbit, rate_hz=500.0, cycles=20.0, noise=0.001))
    >>> found = identify(records, stiffness=2310.0, terms=["F_k", c_4], approaches="direct")
    >>> low, high = found.intervals["c_4"]
    >>> bool(low < 20000.0 < high), found.verdicts["c_4"].verdict
    (True, 'usable')
    """

    symbol: str
    force: Force | None
    words: str = ""
    unit: str = "N sⁿ/mⁿ"
    integral: str = ""
    integral_unit: str = "mⁿ⁺¹/sⁿ"
    order: float = field(default=0, init=False)
    group: str | None = field(default=None, init=False)

    def __new__(cls, symbol: str, *_: Any, **__: Any) -> Term:
        """Make the text that a term is."""
        if not re.fullmatch(NAME, text("symbol", symbol)):
            raise ValueError(f"symbol must be {SYMBOL_IN_WORDS}, got {shown(symbol)}")
        return str.__new__(cls, symbol)

    def __post_init__(self) -> None:
        to_derive = {
            name
            for name in ("words", "unit", "integral", "integral_unit")
            if text(name, getattr(self, name)) == getattr(Term, name)
        }
        if self.force is None:
            return
        order, plain = _power_of(self.symbol, self.force)
        if not plain and to_derive & {"unit", "integral_unit"}:
            raise ValueError(
                f"the force of {self} depends on k or omega: state unit and integral_unit"
            )
        derived = {
            "unit": f"N {_power('s', order)}/{_power('m', order)}",
            "words": f"damping by the power {order:g} of the velocity",
            "integral": f"b_{self}",
            "integral_unit": f"{_power('m', order + 1)}/{_power('s', order)}",
        }
        self.__dict__.update({name: derived[name] for name in to_derive}, order=order)

    def __reduce__(self) -> tuple[Any, ...]:
        """Make the copy of a built-in term that term itself, as its functions cannot be pickled."""
        if self.symbol in KNOWN_TERMS:
            return term, (str(self),)
        return _restored, (str(self), self.__dict__)

    def of_group(self, group: str) -> Term:
        """Return the coefficient that the term has for a group of records: F_k[250 g]."""
        of = {"group": group, "integral": f"{self.integral}[{group}]"}
        return _restored(f"{self.symbol}[{group}]", self.__dict__ | of)

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


def _restored(key: str, state: Mapping[str, Any]) -> Term:
    """Return a term of that text, which knows what another one did; nothing is checked again."""
    made = str.__new__(Term, key)
    made.__dict__.update(state)
    return made


def _power_of(symbol: str, force: Force) -> tuple[float, bool]:
    """Return the power of the velocity that a force grows with, and whether it depends on nothing else, neither k nor
    ω.

    Raises ValueError for a force that is not that of a term.
    """
    v = np.array([[-2.0, -0.5, 0.25], [0.5, 1.0, 2.0]])

    def h(v: Array, w: Array | float = 0.0, k: float = 2310.0, omega: float = 31.0) -> Array:
        w = np.broadcast_to(w, v.shape)
        try:
            value = np.asarray(force(v, w, k, omega), dtype=np.float64)
        except Exception as error:
            raise ValueError(
                f"the force of {symbol} failed for arrays of shape {v.shape}: {type(error).__name__}: {error}; it is a "
                "function of the velocities of the mass and of the base, k and omega: lambda v, w, k, omega: v**3"
            ) from error
        if value.shape != v.shape or not np.isfinite(value).all():
            raise ValueError(
                f"the force of {symbol} must be a finite number for each velocity: for arrays of shape {v.shape} it "
                f"returned {shown(value) if value.shape == v.shape else f'the shape {value.shape}'}"
            )
        return value

    one = float(h(np.ones(1))[0])
    ratio = float(h(np.full(1, 2.0))[0]) / one if one > 0.0 else 0.0
    order: float = round(math.log2(ratio), 9) if ratio > 0.0 else 0.0
    linear, of_base = order == 1.0, float(h(np.zeros(1), 1.0)[0])
    wanted = one * np.abs(v) ** order * np.sign(v)
    alike = [np.allclose(h(v, w), wanted + of_base * w, rtol=1e-9) for w in (0.0, 1.0, v[::-1])]
    if not (one > 0.0 and order >= 1.0 and all(alike) and (linear or of_base == 0.0)):
        raise ValueError(
            f"the force of {symbol} must be a positive number times |v|^(n-1) v with one n of at least 1, such as "
            "abs(v) * v, or linear in v and w: it takes energy at every speed, and scales with the level"
        )
    plain = all(np.array_equal(h(v, 0.5, *at), h(v, 0.5)) for at in ((1.0, 31.0), (2310.0, 1.0)))
    return int(order) if order.is_integer() else order, plain


def _power(unit: str, power: float) -> str:
    """Return a unit to a power: m⁴, s^1.5."""
    if power == 1:
        return unit
    return f"{unit}^{power:g}" if power not in range(10) else unit + "⁰¹²³⁴⁵⁶⁷⁸⁹"[int(power)]


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
        Term("c", lambda v, w, k, omega: v, "viscous damping", integral="b"),
        Term("c_r", lambda v, w, k, omega: v - w, _TO_BASE, integral="b_r"),
        Term("c_2", lambda v, w, k, omega: abs(v) * v, "quadratic damping", integral="b_2"),
        Term("c_3", lambda v, w, k, omega: v * v * v, "cubic damping", integral="b_3"),
        Term("eta", lambda v, w, k, omega: k / omega * v, "structural damping", "", "b_eta", "J"),
    )
}
"""The built-in terms by symbol, in the order of columns in tables: to add one is an entry here.

c : force cẋ.   c_r : c_r(ẋ − ẏ).   c_2 : c_2|ẋ|ẋ.   c_3 : c_3ẋ³.   eta : η(k/ω)ẋ, the loss factor of the spring: at
one frequency it cannot be distinguished from c.
"""

FRICTION = "F_k"


def term(key: str) -> Term:
    """Return the term behind a key: the key itself where it is a term; else a built-in one by its symbol, or by its
    symbol and the group of records that it belongs to, F_k[250 g].

    Raises ValueError for a symbol that is not known, and for another term by the name of a built-in one.
    """
    symbol, bracket, group = key.partition("[")
    built_in = KNOWN_TERMS.get(symbol)
    if isinstance(key, Term):
        if built_in is not None and key.force is not built_in.force:
            raise ValueError(f"symbol {symbol!r} is one of the package: choose another")
        if built_in is None and key.force is None:
            raise ValueError(f"the term {symbol} has no force: give it one")
        return key
    if built_in is None:
        raise ValueError(
            f"unknown term {shown(symbol)}; known are {', '.join(KNOWN_TERMS)}; pass one of your own as a Term"
        )
    return built_in.of_group(group.removesuffix("]")) if bracket else built_in


def in_order(symbols: Iterable[str]) -> tuple[Term, ...]:
    """Return these terms, each once: the built-in ones in the order of `KNOWN_TERMS`, then others as they come. Raises
    ValueError for one that is not known, and for two terms of one symbol."""
    asked: dict[str, Term] = {}
    for one in map(term, symbols):
        if asked.setdefault(one.symbol, one).force is not one.force:
            raise ValueError(f"two terms have the symbol {one.symbol}: choose another for one")
    own = (one for symbol, one in asked.items() if symbol not in KNOWN_TERMS)
    return (*(one for symbol, one in KNOWN_TERMS.items() if symbol in asked), *own)


def symbols_in_words(symbols: Sequence[str]) -> str:
    """Return symbols as a sentence names them: "F_k", "F_k and c", "F_k, c and c_2". Texts use
    `project.wording.listed`, which stands on a higher floor and does without the libraries that this module imports."""
    return " and ".join([", ".join(symbols[:-1]), symbols[-1]] if len(symbols) > 1 else symbols)


_POINTS_OF_TERM = 512  # least number in a cycle; |ẋ|³ has a jump in its third derivative, and the rule an error of 1e-9
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
    points = max(_POINTS_OF_TERM, 1 << math.ceil(math.log2(_PER_HARMONIC * float(n.max()))))
    spectrum = np.zeros((len(x), points // 2 + 1), dtype=np.complex128)
    spectrum[:, n.astype(np.intp)] = 0.5j * omega * points * n * x
    v = np.fft.irfft(spectrum, points, axis=1)
    sigma2 = 0.5 * omega**2 * (variance @ n**2)
    power = of_term.order + 1
    mean = np.mean(of_term.force(v, 0.0, k, omega) * v, axis=1)
    bias = 0.5 * power * (power - 1) * sigma2 * np.mean(np.abs(v) ** (power - 2), axis=1)
    mean -= bias * float(of_term.force(1.0, 0.0, k, omega))
    return np.asarray(2.0 * math.pi / omega * mean)
