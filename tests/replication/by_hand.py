"""The paper's simulation and Table 3 in code of their own, with no formula of the package."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from paper_case import LEVELS, OMEGA, PAIRS, PAPER
from replication.routes import PRINT


def backward_euler(C, K, Y, omega, h, last) -> Iterator[tuple[float, float, float, bool]]:
    """x, ẋ, ẍ and whether the contact sticks after each step from rest, as a researcher would write it: the equation of
    motion divided by m, with C = c/m and K = k/m.   last : the number of steps."""
    F, K_z, Z_m = PAPER.F_k / PAPER.m, PAPER.K_z / PAPER.m, PAPER.F_k / PAPER.K_z
    x = v = z = 0.0
    sticks, direction = True, 0.0
    for n in range(1, last + 1):
        drive = K * Y * math.cos(omega * n * h)
        stiffness = K + K_z if sticks else K
        other = -K_z * (z - x) if sticks else -direction * F
        # ẋ' = ẋ + h (drive + other − C ẋ' − stiffness x'), x' = x + h ẋ'
        new_v = (v + h * (drive + other - stiffness * x)) / (1.0 + h * C + h * h * stiffness)
        new_x, acceleration = x + h * new_v, (new_v - v) / h
        if sticks:
            z += new_x - x
            if abs(z) > Z_m:
                sticks, direction = False, math.copysign(1.0, z)
        elif new_v * direction < 0.0:
            sticks, z = True, direction * Z_m
        x, v = new_x, new_v
        yield x, v, acceleration, sticks


def estimates(omega, Y, X, V_s, phi, t_s, way, sign=+1.0) -> Iterator[tuple[str, str, tuple]]:
    """(column, pair, (F_k, c)) by (16), (18) and (19) solved anew.   way : X + X_s.   sign : under the root of (19)."""
    b, W = math.pi * omega * X**2, math.pi * PAPER.k * Y * X * np.sin(phi)
    travels = {
        "t_s": 2.0 * X * (1.0 + math.cos(omega * t_s)),
        "X_s": 2.0 * (2.0 * X - way),
        "V_s": 2.0 * X * (1.0 + np.sqrt(1.0 + sign * (V_s / (omega * X)) ** 2)),
    }
    for name, a in travels.items():
        for i, j in PAIRS:
            determinant = a[i] * b[j] - a[j] * b[i]
            F_k, c = W[i] * b[j] - W[j] * b[i], a[i] * W[j] - a[j] * W[i]
            yield name, f"{i + 1}-{j + 1}", (F_k / determinant, c / determinant)


def missed(omega=OMEGA, **inputs) -> list[str]:
    """The numbers of Table 3 that inputs at the five levels do not give."""
    names = []
    for column, label, found in estimates(omega, np.array(LEVELS), **inputs):
        for symbol, value in zip(("F_k", "c"), found, strict=True):
            printed = PRINT[f"table3.{column}.{symbol}.{label}"]
            if f"{value:.{printed.decimals}f}" != printed.text:
                names.append(f"{column} {symbol} {label}")
    return names
