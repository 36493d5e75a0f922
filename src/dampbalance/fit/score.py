"""Rao's score test: what one further coefficient would explain of the residual of a fit.

The residual r = (model − data)/σ of a fit has the derivatives J by its unknowns, and g by a coefficient p that the
model lacks. With the unknowns adjusted,

    p = −gᵀr/(gᵀ M g),   M = 1 − J J⁺,

with the variance 1/(gᵀ M g), and the unknowns change by −J⁺g p. This asks for no further
fit. Where the model holds, p over its error is normal whatever g is: a direction that is only roughly right makes the
test weaker, not wrong (Rao, Proc. Cambridge Phil. Soc. 44, 1948).
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy import special

from ..arrays import Array

_RANK = 1e-9  # of the largest singular value


@dataclass(frozen=True, slots=True)
class Departure:
    """Share of the data that a further coefficient would explain.

    symbol : of the coefficient, or words for it.   value, error : in its unit.   p : probability in noise of a
    coefficient as large, either way.   slopes : change of the unknowns of the fit with the coefficient, by name.
    """

    symbol: str
    value: float
    error: float
    p: float
    slopes: Mapping[str, float]

    @property
    def size(self) -> float:
        """The coefficient in standard errors; its square is what it explains of χ²."""
        return self.value / self.error if self.error > 0.0 else 0.0


def departures_from(
    residual: Array,
    known: Array,
    added: Mapping[str, Array],
    names: Sequence[str],
    *,
    noise_known: bool,
    freedom: float | None = None,
) -> list[Departure]:
    """Return what each further coefficient would explain, without those that the data do not show.

    Use it to see whether the model of a fit accounts for the data; the values hold to first order.

    residual : (n,).   known : derivatives by the unknowns of the fit, (n, u), the first of which have `names`.
    added : derivatives by each coefficient, (n,), by symbol.   noise_known : whether the residual is in units of a
    noise that is known; otherwise its scatter gives the noise.   freedom : degrees of freedom of a residual that was
    filtered; default, from the number of samples.
    """
    if not added:
        return []
    whole = np.column_stack([known, *added.values(), residual])
    length = np.linalg.norm(whole, axis=0)
    length[length == 0.0] = 1.0
    size = known.shape[1]
    triangle = np.asarray(np.linalg.qr(whole / length, mode="r"))
    own, others, rest = triangle[:, :size], triangle[:, size:-1], triangle[:, -1]
    inverse = np.linalg.pinv(own, rcond=_RANK)
    moves, rest = inverse @ others, rest - own @ (inverse @ rest)
    if freedom is None:
        freedom = float(residual.size - round(float(np.sum(inverse.T * own))) - 1)
    found = []
    for j, (symbol, g) in enumerate(zip(added, (others - own @ moves).T, strict=True)):
        square = float(g @ g)
        # the others explain all of it, to rounding
        if not square > 1e-10 * float(others[:, j] @ others[:, j]):
            continue
        slope = -float(g @ rest) / square
        if noise_known:
            degrees, error = math.inf, 1.0 / (length[-1] * math.sqrt(square))
        else:
            left = max(float(rest @ rest) - slope**2 * square, 0.0)
            degrees, error = freedom, math.sqrt(left / max(freedom, 1) / square)
        p = 2.0 * float(special.stdtr(degrees, -abs(slope) / error)) if error > 0.0 else 1.0
        unit = length[-1] / length[size + j]
        by = -moves[:, j] * length[size + j] / length[:size]
        slopes = {name: float(of) for name, of in zip(names, by, strict=False)}
        found.append(Departure(symbol, float(slope * unit), float(error * unit), p, slopes))
    return found
