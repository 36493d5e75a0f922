"""The exact steady response of one oscillator."""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

import numpy as np
from numpy.typing import ArrayLike

from ..arguments import instance, numbers, one_of, whole
from ..arrays import Array, Complexes
from ..model import UNITS, BaseMotion, Oscillator, Parameters, named_with_unit, parameters
from .events import MOST_RADIANS, PHASE_S, PHASE_T
from .integrals import Measures, measure
from .regime import Regime
from .states import State, states_in_phases
from .steady import solve_steady
from .steady_harmonics import steady_harmonics

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes

RANGES = {
    "zeta": (1e-5, 50.0),
    "omega_over_omega_n": (1e-2, 1e2),
    "K_z_over_k": (1e-4, 1e8),
    "F_k_over_kY": (1e-6, 1e6),
}
"""Ranges in which the exact solution is tested: the energy balance of 1,400 orbits drawn from here closes to 1e-6."""

MOST_EVENTS = 2e4
"""Highest natural frequency on the contact over that of the drive: a stiff contact chatters, event by event."""

FEATURES = ("X", "X_s", "V_s", "t_s", "phi", "phi_zero_crossing", "a", "b", "W")
SHOWN_FIRST = ("X", "phi", "W")
_SIGNS = {
    **{"v": r"\dot x", "acceleration": r"\ddot x", "phi": r"\varphi", "omega": r"\omega"},
    "zero_crossing": r"\mathrm{zero\ crossing}",
}


class NoSteadyOrbit(ArithmeticError):
    """The oscillator has no steady orbit, or none was found."""


@dataclass(frozen=True, eq=False, repr=False)
class Orbit:
    """Steady orbit: the phases of its half cycle, from the reversal at x = −X on, and everything that follows from
    them.

    The other half cycle is the mirror image, x(t + T/2) = −x(t). Features are exact to rounding; one that does not
    exist is NaN, and `regime` says why.

    oscillator, motion : what the orbit belongs to.   regime : pattern of slip and stick.
    theta : phase of the base, ωt, at the reversal at −X, rad.
    phases : (n, 5), rows (t, s, x, ẋ, z) at the start of each phase; t from the reversal, s; s = ±1 in slip, 0 in
    stick.
    """

    oscillator: Oscillator
    motion: BaseMotion
    regime: Regime
    theta: float
    phases: Array

    def __post_init__(self) -> None:
        self.phases.flags.writeable = False

    @cached_property
    def parameters(self) -> Parameters:
        """The oscillator and the motion as the plain numbers that kernels take."""
        return parameters(self.oscillator, self.motion)

    @cached_property
    def _measures(self) -> Measures:
        return measure(self.phases, len(self.phases), self.theta, self.parameters)

    @property
    def X(self) -> float:
        """Peak displacement, m."""
        return self._measures.X

    @property
    def X_s(self) -> float:
        """Displacement at the first forward slip onset after the reversal, m; NaN without slip."""
        return self._measures.X_s

    @property
    def V_s(self) -> float:
        """Velocity at that slip onset, m/s; NaN without slip."""
        return self._measures.V_s

    @property
    def t_s(self) -> float:
        """Time of that slip onset counted from the reversal t_1 at −X, s, as in Eqs. (17), (18); NaN without slip."""
        return self._measures.t_s

    @property
    def phi(self) -> float:
        """Lag of the velocity reversal at x = +X behind the base's peak, rad."""
        return self._measures.phi

    @property
    def phi_zero_crossing(self) -> float:
        """Lag of the upward zero crossing of x behind that of the base, rad."""
        return self._measures.phi_zero_crossing

    @property
    def t_1(self) -> float:
        """Time of the reversal at −X that precedes t_2, s (y = Y cos ωt)."""
        return (self.phi - math.pi) / self.motion.omega

    @property
    def t_2(self) -> float:
        """Time of the reversal at +X, φ/ω, s."""
        return self.phi / self.motion.omega

    @property
    def a(self) -> float:
        """Distance slid per cycle, ∮ |ẋ| dt over the slip phases, m: Eq. (7a)."""
        return self._measures.a

    @property
    def b(self) -> float:
        """Viscous integral ∮ ẋ² dt, m²/s: Eq. (7b)."""
        return self._measures.b

    @property
    def W(self) -> float:
        """Work put in per cycle, ∮ k y ẋ dt, J: Eq. (5)."""
        return self._measures.W

    def harmonic(self, n: int) -> tuple[float, float]:
        """Return (X_n, φ_n) of x = Σ X_n cos(nωt − φ_n), m and rad, for n = 1, 3, 5. Even harmonics vanish by
        symmetry."""
        if whole("n", n) not in (1, 3, 5):
            raise ValueError(f"harmonic n must be 1, 3 or 5, got {n!r}")
        return getattr(self._measures, f"X_{int(n)}"), getattr(self._measures, f"phi_{int(n)}")

    def harmonics(self, count: int) -> Complexes:
        """Return x_n of x = Re Σ x_n e^{inωt}, n = 1, 3 … 2 count − 1, m, shape (count,); x_n = X_n e^{−iφ_n}."""
        n = whole("count", count)
        return steady_harmonics(self.phases, self.theta, self.parameters, self.regime, n)

    def state(self, t: ArrayLike) -> State:
        """Return (x, ẋ, ẍ, z) at the times t, s, any shape; y = Y cos ωt."""
        times = numbers("t", t)
        return State(*(row.reshape(times.shape) for row in self.states(times.ravel())))

    def states(self, times: Array) -> Array:
        """Return x, ẋ, ẍ, z at times that are known to be numbers, s (n,), as rows (4, n): for loops of many calls."""
        period = self.motion.period
        since = np.mod(times - self.theta / self.motion.omega, period)
        mirrored = since >= 0.5 * period
        since[mirrored] -= 0.5 * period
        rows = states_in_phases(since, self.phases, self.theta, self.parameters)
        return np.negative(rows, out=rows, where=mirrored)

    def to_frame(self) -> pd.DataFrame:
        """Return one row: the oscillator, its excitation and the features of the orbit, in columns named with their
        units, and the regime in words. `pandas.concat` puts the rows of several orbits together."""
        import pandas as pd  # slow to import

        numbers = self.parameters._asdict() | {name: getattr(self, name) for name in FEATURES}
        row = {named_with_unit(name, UNITS[name]): value for name, value in numbers.items()}
        return pd.DataFrame([row | {"regime": str(self.regime)}])

    def plot(
        self, quantity: str = "x", against: str = "t", *, ax: Axes | None = None, **style: Any
    ) -> Axes:
        """Draw one period, from the reversal at −X on, and return the axes; the thick parts are those in stick.

        quantity, against : t, x, v, acceleration, z (deflection of the contact spring) or y (base), in SI units.
        `plot("acceleration", "x")` is the loop in which the paper reads the microstick line.
        ax : axes to draw in; default, new ones of pyplot.   style : properties of the lines, as in `Axes.plot`.

        Raises ValueError for an unknown quantity.
        """
        drawn = {"quantity": quantity, "against": against}
        for name, value in drawn.items():
            one_of(name, value, ("t", *State._fields, "y"))
        ax = ax or new_axes()
        half, start = 0.5 * self.motion.period, self.theta / self.motion.omega
        begins = self.phases[:, PHASE_T]
        ends = np.append(begins[1:], half)

        def line(since: Array) -> tuple[Array, Array]:
            t = start + since
            at = {"t": t, **self.state(t)._asdict(), "y": self.motion.y(t)}
            return at[against], at[quantity]

        whole_period = np.union1d(
            # of a period that is drawn
            np.linspace(0.0, 2.0 * half, 2001),
            [*begins, *(half + begins)],
        )
        (drawn_line,) = ax.plot(*line(whole_period), **style)
        width = 2.5 * drawn_line.get_linewidth()
        stick: dict[str, Any] = {"color": drawn_line.get_color(), "linewidth": width}
        for i in np.flatnonzero(self.phases[:, PHASE_S] == 0.0):
            for of_half in (0.0, half):
                ax.plot(*line(of_half + np.linspace(begins[i], ends[i], 100)), **stick)
        ax.set(xlabel=axis_label(against), ylabel=axis_label(quantity))
        return ax

    def __repr__(self) -> str:
        """Return the values, then the oscillator and its excitation."""
        first = f"{in_words(self, SHOWN_FIRST)}: {self.regime}"
        others = in_words(self, [name for name in FEATURES if name not in SHOWN_FIRST])
        return "Orbit  " + "\n       ".join([first, others, f"{self.oscillator}, {self.motion}"])

    def _repr_html_(self) -> str:
        """Return the values and the arguments as a table."""
        frame = self.to_frame()
        values_first = frame.columns[np.roll(np.arange(frame.shape[1]), -len(self.parameters))]
        html: str = frame[values_first].T.to_html(header=False, float_format="{:.6g}".format)
        return html

    def to_dict(self) -> dict[str, Any]:
        """Return the orbit as plain numbers and lists, from which `from_dict` makes it again, bit for bit."""
        return {
            "oscillator": asdict(self.oscillator),
            "motion": asdict(self.motion),
            "regime": self.regime.name,
            "theta": self.theta,
            "phases": self.phases.tolist(),
        }

    @classmethod
    def from_dict(cls, data: dict[str, Any]) -> Self:
        """Return the orbit that `to_dict` described."""
        return cls(
            Oscillator(**data["oscillator"]),
            BaseMotion(**data["motion"]),
            Regime[data["regime"]],
            float(data["theta"]),
            np.array(data["phases"], dtype=float).reshape(-1, 5),
        )


def new_axes() -> Axes:
    """Return the axes of a new figure of pyplot."""
    from matplotlib import pyplot  # slow to import

    return pyplot.figure(layout="constrained").add_subplot()


def symbol(name: str) -> str:
    """Return the symbol of a quantity in TeX: phi_1 becomes $\\varphi_{1}$."""
    letter, _, index = name.partition("_")
    subscript = f"_{{{_SIGNS.get(index, index)}}}" if index else ""
    return f"${_SIGNS.get(letter, letter)}{subscript}$"


def axis_label(name: str) -> str:
    """Return the label of an axis: the symbol of a quantity, and its unit."""
    return f"{symbol(name)} ({UNITS[name]})"


def in_words(features: Any, names: Sequence[str], index: Any = None) -> str:
    """Return features with their units, X = 0.002728 m; of an array that at `index`."""
    words = []
    for name in names:
        value = getattr(features, name)
        value = value if index is None else value[index]
        words.append(f"{'φ' if name == 'phi' else name} = {value:.4g} {UNITS[name]}")
    return ", ".join(words)


def read_orbits(path: str | Path) -> list[Orbit]:
    """Return the orbits of a JSON file that holds a list of `Orbit.to_dict`."""
    return [Orbit.from_dict(data) for data in json.loads(Path(path).read_text(encoding="utf-8"))]


def steady_orbit(
    oscillator: Oscillator, motion: BaseMotion, *, most_radians: float = MOST_RADIANS
) -> Orbit:
    """Return the steady response to harmonic base motion, exact to rounding, in any regime of stick and slip.

    Use it for one case and all that follows from it: the motion in time, harmonics, plots. `steady_orbits` solves many
    cases at once, about a million per second.

    most_radians : limit of the search for an orbit with several slips per half cycle, in radians of the fastest motion
    of the oscillator. The default takes seconds at most; choose less to give up earlier.

    Raises NoSteadyOrbit if there is no steady response (an undamped oscillator driven at resonance, with F_k < πkY/4)
    or none was found, and ValueError for arguments of other classes.

    >>> import math
    >>> from dampbalance import BaseMotion, Oscillator, steady_orbit
    >>> osc = Oscillator(m=2.42, c=90.0, k=2310.0, K_z=208000.0, F_k=1.28)
    >>> orbit = steady_orbit(osc, BaseMotion(Y=0.004, omega=2 * math.pi * 4.92))
    >>> f"X = {1000 * orbit.X:.3f} mm, X_s = {1000 * orbit.X_s:.3f} mm, t_s = {1000 * orbit.t_s:.2f} ms"
    'X = 2.728 mm, X_s = -2.716 mm, t_s = 2.98 ms'
    >>> abs(orbit.a * osc.F_k + orbit.b * osc.c - orbit.W) < 1e-16
    True
    >>> str(orbit.regime)
    'one slip onset per half cycle'
    """
    par = parameters(oscillator, instance("motion", motion, BaseMotion))
    code, phases, theta = solve_steady(par, most_radians)
    regime = Regime(code)
    if regime is Regime.NOT_FOUND:
        raise NoSteadyOrbit(f"no steady orbit found for {oscillator} under {motion}")
    return Orbit(oscillator, motion, regime, theta, phases)
