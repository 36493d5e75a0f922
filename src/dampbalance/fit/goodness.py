"""How well a model fits records: χ², its probability in noise, and the linear oscillator, whose contact never slips."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy import special

from ..arrays import Complexes
from ..law.terms import term
from ..signals.record_harmonics import RecordHarmonics
from ..signals.thresholds import P_OF_THE_MODEL, SHOWS
from ..solver import NORMAL_95
from .nuisances import base_of


class LinearFit(NamedTuple):
    """A linear oscillator, and how well it fits records.

    k : N/m.   chi_square, freedom : χ² and its degrees of freedom.
    contact, contact_error : stiffness K of a contact that only sticks, N/m, with its standard error, infinite where the
    records cannot separate it from the inertia.   by_mass : derivative of K by the mass that is given, (rad/s)².
    """

    k: float
    chi_square: float
    freedom: int
    contact: float
    contact_error: float
    by_mass: float

    @property
    def sticks(self) -> bool | None:
        """Whether there is a contact that only sticks; None where the records cannot decide."""
        if self.contact**2 > SHOWS * self.contact_error**2:
            return self.contact > 0.0
        # no contact of a rig is softer than its spring
        return False if self.contact + NORMAL_95 * self.contact_error < self.k else None


def linear_fit(
    lines: Sequence[RecordHarmonics],
    k: float,
    terms: Sequence[str] = ("c",),
    m: float | None = None,
    m_error: float = 0.0,
) -> LinearFit:
    """Return the linear oscillator that fits records.

    It has (k + K − mω² + iωΣ p_j h_j) x_1 = kY, K the stiffness of a contact that only sticks, and likewise at nω
    where the base has a harmonic y_n; no other harmonics. No contact has a K below zero: the k is then not that of the
    records.

    k : N/m.   terms : of its damping, of which those that are linear count.   m, m_error : mass with its standard
    uncertainty, kg; default, it is fitted.
    """
    rows: list[Complexes] = []
    chi_square = 0.0
    for one in lines:
        y = base_of(one)
        driven = one.clear & (y != 0.0)
        chi_square += float(np.sum(np.abs(one.x / one.x_error)[~driven] ** 2))
        relative = one.x_error[driven] / np.abs(one.x[driven])
        relative[0] = one.relative_error
        omega = np.full(relative.size, one.omega)
        rows.append(np.stack([y[driven] / one.x[driven], relative, one.n[driven] * omega, omega]))
    ratio, *others = np.concatenate(rows, axis=1)
    relative, rate, omega = np.real(others)
    z, error = k * (ratio - 1.0), k * np.abs(ratio) * relative
    columns, known = [np.ones(rate.size)], rate**2 if m is not None else 0.0 * rate
    columns += [rate**2] if m is None else []
    for symbol in terms:
        of = term(symbol)
        if of.force is not None and of.linear:
            columns.append(1j * rate * of.force(1.0, ratio, k, omega))
    matrix = np.column_stack(columns) / error[:, None]
    matrix = np.vstack([matrix.real, matrix.imag])
    length = np.linalg.norm(matrix, axis=0)
    inverse = np.linalg.pinv(matrix / length, rcond=1e-6)
    inertia = np.concatenate([known / error, 0.0 * error])
    right = np.concatenate([z.real / error, z.imag / error]) + (m or 0.0) * inertia
    known_parts = np.sum(inverse.T * matrix / length, axis=0)  # 1 of what the records determine
    chi_square += float(np.sum((matrix / length @ (inverse @ right) - right) ** 2))
    to_K = inverse[0] / length[0]
    by_mass = float(to_K @ inertia)
    K_error = math.hypot(float(np.linalg.norm(to_K)), by_mass * m_error)
    return LinearFit(
        k,
        chi_square,
        2 * sum(one.n.size for one in lines) - round(float(np.sum(known_parts))),
        float(to_K @ right),
        K_error if known_parts[0] > 0.999 else math.inf,
        by_mass,
    )


def improbable(chi_square: float, freedom: float, lines: Sequence[RecordHarmonics]) -> bool:
    """Return whether noise hardly ever makes χ² this large (`P_OF_THE_MODEL`)."""
    return probability(chi_square, freedom, lines) < P_OF_THE_MODEL


def probability(chi_square: float, freedom: float, lines: Sequence[RecordHarmonics]) -> float:
    """Return the probability that noise makes χ² at least this large; 1 without degrees of freedom.

    χ² per degree of freedom has an F distribution, since the errors come from the scatter of a number of rows.
    """
    if freedom < 1:
        return 1.0
    of_errors = sum(one.error_freedom for one in lines)
    return float(special.fdtrc(freedom, of_errors, chi_square / freedom))
