"""The exact steady response of many oscillators at once."""

from __future__ import annotations

import functools
import itertools
import os
from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from ..arguments import instance, numbers, one_of, whole
from ..arrays import Array, Codes
from ..jit import jit
from ..model import UNITS, Oscillator, Parameters, named_with_unit
from .events import MOST_RADIANS
from .integrals import Measures, write_measures
from .orbit import SHOWN_FIRST, axis_label, in_words, new_axes, symbol
from .regime import Regime
from .steady import MAX_PHASES, NO_CLOSED_FORM, solve_closed, solve_otherwise

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes
    from matplotlib.cm import ScalarMappable

_SHOWN, _NAMED = 5, 10  # cases that a repr lists, and lines that a legend names, at most
_BLOCK = 4096  # cases handed to a thread at a time: the scratch memory stays below a megabyte


@dataclass(frozen=True, eq=False, repr=False)
class Orbits:
    """Features of many steady orbits, arrays of the broadcast shape of the inputs; names and units as in `Orbit`.

    X_n, phi_n : amplitude, m, and lag, rad, of the odd harmonics.   regime : codes of `Regime` (uint8).
    given : the arguments of `steady_orbits`, of the same shape.
    A feature that does not exist is NaN, and `regime` says why; where no orbit was found everything is NaN.
    """

    X: Array
    X_s: Array
    V_s: Array
    t_s: Array
    phi: Array
    phi_zero_crossing: Array
    a: Array
    b: Array
    W: Array
    X_1: Array
    phi_1: Array
    X_3: Array
    phi_3: Array
    X_5: Array
    phi_5: Array
    regime: Codes
    given: Mapping[str, Array]

    @property
    def varied(self) -> tuple[str, ...]:
        """The arguments that are not the same in all cases."""
        return tuple(name for name, of in self.given.items() if of.size and np.ptp(of) > 0.0)

    def to_frame(self) -> pd.DataFrame:
        """Return a row for each case, the last axis running fastest: the arguments, the features and the regime in
        words, in columns named with their units."""
        import pandas as pd  # slow to import

        features = {name: getattr(self, name) for name in Measures._fields}
        columns = {
            named_with_unit(name, UNITS[name]): of.ravel()
            for name, of in (dict(self.given) | features).items()
        }
        words: Any = [str(one) for one in Regime]
        regime = pd.Categorical.from_codes(self.regime.ravel(), words)
        return pd.DataFrame(columns | {"regime": regime})

    def plot(
        self, feature: str = "X", against: str = "", *, ax: Axes | None = None, **style: Any
    ) -> Axes:
        """Draw a feature against an argument that varies, SI units, and return the axes: a line for each set of the
        others. A legend names up to ten lines; more are coloured by the argument of most values, with a colour bar.

        feature : name of a field.   against : name of an argument; default, the one that has the most values.
        ax : axes to draw in; default, new ones of pyplot.   style : properties of the lines, as in `Axes.plot`.

        Raises ValueError for an unknown feature, and for an argument that is the same in all cases.
        """
        one_of("feature", feature, Measures._fields)
        if not self.varied:
            raise ValueError("nothing varies in these orbits: give arrays to steady_orbits")
        most = max(self.varied, key=lambda name: np.unique(self.given[name]).size)
        against = one_of("against", against, self.varied) if against else most
        ax = ax or new_axes()
        x, y = self.given[against].ravel(), getattr(self, feature).ravel()
        others = {name: self.given[name].ravel() for name in self.varied if name != against}
        sets, member = np.unique(
            np.array([*others.values()]).reshape(-1, x.size), axis=1, return_inverse=True
        )
        if sets.shape[1] == x.size:  # they vary with it
            sets, member = sets[:0, :1], np.zeros(x.size, dtype=np.intp)
        colours = None
        if sets.shape[1] > _NAMED and not {"color", "c"} & style.keys():
            by = max(others, key=lambda name: np.unique(others[name]).size)
            colours = _colour_bar(ax, by, others[by])
        for i, values in enumerate(sets.T):
            those = np.flatnonzero(member.ravel() == i)
            those = those[np.argsort(x[those], kind="stable")]
            named = [
                f"{symbol(n)} = {v:.4g} {UNITS[n]}" for n, v in zip(others, values, strict=False)
            ]
            label = {"label": ", ".join(named)} if named and sets.shape[1] <= _NAMED else {}
            look = {"color": colours.to_rgba(others[by][those[0]])} if colours else label
            ax.plot(x[those], y[those], **(look | style))
        ax.set(xlabel=axis_label(against), ylabel=axis_label(feature))
        if ax.get_legend_handles_labels()[1]:
            ax.legend()
        return ax

    def __repr__(self) -> str:
        """Return the values of the first cases, with the arguments that vary."""
        lines = []
        for index in itertools.islice(np.ndindex(self.X.shape), _SHOWN):
            of = ", ".join(f"{n} = {self.given[n][index]:.4g} {UNITS[n]}" for n in self.varied)
            values = f"{in_words(self, SHOWN_FIRST, index)}: {Regime(int(self.regime[index]))}"
            lines.append(f"{of}:  {values}" if of else values)
        more = [f"… and {self.X.size - _SHOWN:,} more"] * (self.X.size > _SHOWN)
        head = f"Orbits  shape {self.X.shape}"
        return "\n    ".join([head, *lines, *more])

    def _repr_html_(self) -> str:
        """Return the arguments and all features as a table."""
        html: str = self.to_frame().to_html(max_rows=2 * _SHOWN, float_format="{:.6g}".format)
        return html


def _colour_bar(axes: Axes, name: str, values: Array) -> ScalarMappable:
    """Draw a bar of colours for the values of an argument, and return it; logarithmic over a factor of ten or more."""
    from matplotlib import cm, colors  # slow to import

    low, high = float(values.min()), float(values.max())
    norm = colors.LogNorm if low > 0.0 and high >= 10.0 * low else colors.Normalize
    colours = cm.ScalarMappable(norm(low, high), "viridis")
    axes.figure.colorbar(colours, ax=axes, label=axis_label(name))
    return colours


def steady_orbits(
    oscillator: Oscillator | None = None,
    /,
    *,
    Y: ArrayLike,
    omega: ArrayLike,
    m: ArrayLike | None = None,
    c: ArrayLike | None = None,
    k: ArrayLike | None = None,
    K_z: ArrayLike | None = None,
    F_k: ArrayLike | None = None,
    threads: int | None = None,
    device: str = "cpu",
    fetch: bool = True,
) -> Orbits:
    """Compute the steady responses of many cases, exact to rounding, in any regime of stick and slip.

    Use it for sweeps, maps and samples; the arguments broadcast as in NumPy, and the results have their common shape.
    It solves about a million cases per second on two cores. `steady_orbit` also gives the motion in time of one case.

    oscillator : default values of m, c, k, K_z and F_k; without one, give all five by name.
    m, c, k, K_z, F_k : kg, N s/m, N/m, N/m, N; they replace the values of `oscillator`.
    Y, omega : amplitude of the base, m, and circular frequency of the drive, rad/s.
    threads : default, the cores that this process may use; the results do not depend on it.
    device : "cuda" solves cases with a closed form on an NVIDIA GPU, with the package's extra `cuda`; the processor
    solves the rest, those with several slip onsets. Choose it from about 10⁶ cases on.
    fetch : False leaves features and regimes on the device, as arrays that CuPy and PyTorch take.

    Raises RuntimeError for a device that is not available, and ValueError for shapes that do not broadcast or a value
    that `Oscillator` refuses, masked and missing ones included, naming the argument and the first such value.

    >>> import math
    >>> from dampbalance import Oscillator, Regime, steady_orbits
    >>> osc = Oscillator(m=2.42, c=90.0, k=2310.0, K_z=208000.0, F_k=1.28)
    >>> orbits = steady_orbits(osc, Y=[0.0002, 0.004, 0.012], omega=2 * math.pi * 4.92)
    >>> [f"{1000 * X:.3f}" for X in orbits.X]
    ['0.002', '2.728', '9.369']
    >>> str(Regime(orbits.regime[0]))
    'no slip: the contact only sticks'
    >>> list(orbits.to_frame()["X_m"].round(6))
    [2e-06, 0.002728, 0.009369]
    >>> softer = steady_orbits(osc, K_z=[208000.0, 20800.0], Y=0.004, omega=2 * math.pi * 4.92)
    >>> [f"{1000 * X:.3f}" for X in softer.X]
    ['2.728', '2.752']
    """
    own = {"m": m, "c": c, "k": k, "K_z": K_z, "F_k": F_k}
    if oscillator is not None:
        o = instance("oscillator", oscillator, Oscillator)
        own = {name: getattr(o, name) if of is None else of for name, of in own.items()}
    given: dict[str, Any] = {**own, "Y": Y, "omega": omega}
    arrays = [numbers(name, value) for name, value in given.items()]
    shape = _common_shape(arrays)
    views = [np.broadcast_to(a, shape) for a in arrays]
    solver = functools.partial(_by_processor, threads=threads)
    out: Any
    if one_of("device", device, ("cpu", "cuda")) == "cuda":
        from .device import solve_on_device  # slow to import

        out, regime = solve_on_device(arrays, shape, solver, fetch)
    else:
        out, regime = solver(views)
    fields: dict[str, Any] = dict(zip((*Measures._fields, "regime"), (*out, regime), strict=True))
    arrays_of = {name: row.reshape(shape) for name, row in fields.items()}
    return Orbits(**arrays_of, given=dict(zip(given, views, strict=True)))


def _by_processor(views: Sequence[Array], threads: int | None) -> tuple[Array, Codes]:
    """Return the rows (15, n) of `Measures` and the regimes (n,) of all cases of arrays of one shape."""
    size = views[0].size
    out = np.empty((len(Measures._fields), size))
    regime = np.empty(size, dtype=np.uint8)

    def solve(start: int) -> None:
        block = slice(start, start + _BLOCK)
        inputs = tuple(view.flat[block] for view in views)
        # contiguous: for another layout Numba would compile anew
        part = np.empty((len(out), len(inputs[0])))
        if _solve_closed_forms(inputs, part, regime[block]):
            _solve_others(inputs, part, regime[block])
        out[:, block] = part

    if threads is None:
        cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    else:
        cores = whole("threads", threads)
    with ThreadPoolExecutor(max_workers=cores or 1) as pool:
        for _ in pool.map(solve, range(0, size, _BLOCK)):
            pass
    return out, regime


def _common_shape(arrays: list[Array]) -> tuple[int, ...]:
    try:
        return np.broadcast_shapes(*(a.shape for a in arrays))
    except ValueError:
        named = zip(Parameters._fields, arrays, strict=True)
        shapes = ", ".join(f"{name} {a.shape}" for name, a in named)
        raise ValueError(f"the arguments do not broadcast to one shape: {shapes}") from None


@jit
def _solve_closed_forms(inputs: tuple[Array, ...], out: Array, regime: Codes) -> int:
    """Solve what has a closed form; return how many cases, now of the regime NO_CLOSED_FORM, are left to
    `_solve_others`.

    inputs : the arrays (n,) of `Parameters`.   Rows of `out` (15, n) receive the fields of `Measures`.
    """
    phases, left = np.empty((2, 5)), 0
    for i, of_case in enumerate(zip(*inputs)):  # noqa: B905 (no strict= in compiled code)
        par = Parameters(*of_case)
        code, count, theta = solve_closed(par, phases)
        regime[i] = code
        if code == NO_CLOSED_FORM:
            left += 1
        else:
            write_measures(out, i, phases, count, theta, par)
    return left


@jit
def _solve_others(inputs: tuple[Array, ...], out: Array, regime: Codes) -> None:
    """Solve the cases that `_solve_closed_forms` left; arguments as there."""
    phases = np.empty((MAX_PHASES, 5))
    for i, of_case in enumerate(zip(*inputs)):  # noqa: B905 (no strict= in compiled code)
        if regime[i] == NO_CLOSED_FORM:
            par = Parameters(*of_case)
            code, count, theta = solve_otherwise(par, phases, MOST_RADIANS)
            regime[i] = code
            write_measures(out, i, phases, count, theta, par)
