"""How well a model fits records: χ², its probability in noise, and χ² about an oscillator whose contact never slips."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy import special

from ..arrays import Complexes
from ..law.terms import term
from ..signals.lines import Lines
from ..signals.thresholds import P_OF_THE_MODEL


def linear_misfit(
    lines: Sequence[Lines], k: float, terms: Sequence[str] = ("c",)
) -> tuple[float, int]:
    """Return χ² of the records about a linear oscillator, and its degrees of freedom.

    It has (k + K − mω² + iωΣ p_j h_j) x_1 = kY, K ≥ 0 the stiffness of a contact that only sticks, and likewise at nω
    where the base has a harmonic y_n; no other harmonics.

    terms : of its damping, of which those that are linear count.
    """
    rows: list[Complexes] = []
    chi_square = 0.0
    for one in lines:
        y = np.zeros(2 * one.n.size, dtype=np.complex128)
        y[1], y[2 : one.base.size + 2] = one.Y, one.base[: y.size - 2]
        y = y[one.n]
        driven = one.clear & (y != 0.0)
        chi_square += float(np.sum(np.abs(one.x / one.x_error)[~driven] ** 2))
        relative = one.x_error[driven] / np.abs(one.x[driven])
        relative[0] = one.relative_error
        omega = np.full(relative.size, one.omega)
        rows.append(np.stack([y[driven] / one.x[driven], relative, one.n[driven] * omega, omega]))
    ratio, *others = np.concatenate(rows, axis=1)
    relative, rate, omega = np.real(others)
    z, error = k * (ratio - 1.0), k * np.abs(ratio) * relative
    columns = [np.ones(rate.size), rate**2]
    for symbol in terms:
        of = term(symbol)
        if of.force is not None and of.linear:
            columns.append(1j * rate * of.force(1.0, ratio, k, omega))
    matrix = np.column_stack(columns) / error[:, None]
    matrix = np.vstack([matrix.real, matrix.imag])
    matrix /= np.linalg.norm(matrix, axis=0)
    right = np.concatenate([z.real / error, z.imag / error])
    solution, _, rank, _ = np.linalg.lstsq(matrix, right, rcond=1e-6)
    chi_square += float(np.sum((matrix @ solution - right) ** 2))
    return chi_square, 2 * sum(one.n.size for one in lines) - int(rank)


def improbable(chi_square: float, freedom: int, lines: Sequence[Lines]) -> bool:
    """Return whether noise makes a χ² as large as this hardly ever (`P_OF_THE_MODEL`)."""
    return probability(chi_square, freedom, lines) < P_OF_THE_MODEL


def probability(chi_square: float, freedom: int, lines: Sequence[Lines]) -> float:
    """Return the probability of a χ² as large as this in noise; 1 without freedom.

    The errors come from a number of rows, and so it has an F distribution.
    """
    if freedom < 1:
        return 1.0
    of_errors = sum(one.error_freedom for one in lines)
    return float(special.fdtrc(freedom, of_errors, chi_square / freedom))
