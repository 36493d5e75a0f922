"""The pair-wise formulas of the paper, written out as printed: Eqs. (8) and (15) to (19).

They are here to test the solver, which knows none of them. Arguments are scalars of two responses, SI units; each
function returns (F_k, c).
"""

from __future__ import annotations

from math import cos, pi, sin, sqrt


def eq_8(a_i, a_j, b_i, b_j, W_i, W_j):
    """Direct integration."""
    delta = a_i * b_j - a_j * b_i
    F_k = (b_j * W_i - b_i * W_j) / delta
    c = (a_i * W_j - a_j * W_i) / delta
    return F_k, c


def eq_15(k, omega, Y_1, Y_2, X_1, X_2, X_1s, X_2s, phi_1, phi_2):
    """X_s, individual phases."""
    q_1, q_2 = X_1 - X_1s, X_2 - X_2s
    below = q_1 * X_2**2 - q_2 * X_1**2
    F_k = pi * k * (Y_1 * X_1 * X_2**2 * sin(phi_1) - Y_2 * X_1**2 * X_2 * sin(phi_2)) / (2 * below)
    c = k * (q_1 * Y_2 * X_2 * sin(phi_2) - q_2 * Y_1 * X_1 * sin(phi_1)) / (omega * below)
    return F_k, c


def eq_16(k, omega, Y_1, Y_2, X_1, X_2, X_1s, X_2s, phi):
    """X_s, one phase for both."""
    q_1, q_2 = X_1 - X_1s, X_2 - X_2s
    below = q_1 * X_2**2 - q_2 * X_1**2
    F_k = pi * k * X_1 * X_2 * sin(phi) * (Y_1 * X_2 - Y_2 * X_1) / (2 * below)
    c = k * sin(phi) * (q_1 * Y_2 * X_2 - q_2 * Y_1 * X_1) / (omega * below)
    return F_k, c


def eq_17(k, omega, Y_1, Y_2, X_1, X_2, t_s1, t_s2, phi_1, phi_2):
    """t_s, individual phases and times; the paper gives F_k only."""
    below = X_2 * (1 + cos(omega * t_s1)) - X_1 * (1 + cos(omega * t_s2))
    return pi * k * (Y_1 * X_2 * sin(phi_1) - Y_2 * X_1 * sin(phi_2)) / (2 * below)


def eq_18(k, omega, Y_1, Y_2, X_1, X_2, t_s, phi):
    """t_s, one phase and one time for both."""
    F_k = pi * k * sin(phi) * (Y_1 * X_2 - Y_2 * X_1) / (2 * (1 + cos(omega * t_s)) * (X_2 - X_1))
    c = k * sin(phi) * (Y_1 - Y_2) / (omega * (X_1 - X_2))
    return F_k, c


def eq_19(k, omega, Y_1, Y_2, X_1, X_2, V_s1, V_s2, phi):
    """V_s, one phase for both."""
    alpha_1 = omega * X_1 + sqrt((omega * X_1) ** 2 - V_s1**2)
    alpha_2 = omega * X_2 + sqrt((omega * X_2) ** 2 - V_s2**2)
    below = alpha_1 * X_2**2 - alpha_2 * X_1**2
    F_k = pi * k * omega * X_1 * X_2 * sin(phi) * (Y_1 * X_2 - Y_2 * X_1) / (2 * below)
    c = k * sin(phi) * (alpha_1 * Y_2 * X_2 - alpha_2 * Y_1 * X_1) / (omega * below)
    return F_k, c
