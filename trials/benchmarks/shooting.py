"""Shooting, as every peer uses it: two unknowns, X and θ of the reversal, such that half a period later x = X, ẋ = 0.

Broyden's method from the good guess, with a first derivative by differences: some eight half cycles, where a motion
takes ten to thirty-five to settle. All functions work elementwise: on floats, or on arrays of cases (NumPy, JAX).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

DIFFERENCE = 1e-6  # of the first difference quotients, relative to X and in rad
MOST_STEPS = 30
_NOTHING = 1e-300  # keeps 0/0 away from a case that has converged to the last bit

Number = Any  # float or array
Jacobian = tuple[Number, Number, Number, Number]
Residual = Callable[[Number, Number], tuple[Number, Number]]


def first_jacobian(residual: Residual, u: Number, v: Number, f: Number, g: Number) -> Jacobian:
    """Return (∂f/∂u, ∂f/∂v, ∂g/∂u, ∂g/∂v) by forward differences; f, g = residual(u, v)."""
    f_u, g_u = residual(u + DIFFERENCE, v)
    f_v, g_v = residual(u, v + DIFFERENCE)
    return tuple(change / DIFFERENCE for change in (f_u - f, f_v - f, g_u - g, g_v - g))


def newton_step(jacobian: Jacobian, f: Number, g: Number) -> tuple[Number, Number]:
    """Return (δu, δv) that brings the linear model to zero."""
    a, b, c, d = jacobian
    det = a * d - b * c
    return (b * g - d * f) / det, (c * f - a * g) / det


def broyden_update(jacobian: Jacobian, du: Number, dv: Number, f: Number, g: Number) -> Jacobian:
    """Return the Jacobian nearest to the last one that explains the residual (f, g) after the step (δu, δv)."""
    a, b, c, d = jacobian
    square = du * du + dv * dv + _NOTHING
    return a + f * du / square, b + f * dv / square, c + g * du / square, d + g * dv / square


def broyden(
    residual: Residual, u: Number, v: Number, settled: Callable[[Number, Number], bool]
) -> tuple[Number, Number]:
    """Return (u, v) at which the residual is settled; the last call of `residual` is the one there."""
    f, g = residual(u, v)
    jacobian = first_jacobian(residual, u, v, f, g)
    for _ in range(MOST_STEPS):
        du, dv = newton_step(jacobian, f, g)
        u, v = u + du, v + dv
        f, g = residual(u, v)
        if settled(f, g):
            return u, v
        jacobian = broyden_update(jacobian, du, dv, f, g)
    raise ArithmeticError(f"shooting did not converge in {MOST_STEPS} steps")
