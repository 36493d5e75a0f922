"""Contacts identified from stepped lines: of joints whose loss and stiffness come from formulas of their own."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from dampbalance.fit.contacts import compare_contacts, fit_contact
from dampbalance.fit.stiffness_lines import StiffnessLines

M, K, C, K_Z, R_SLIP = 1.5, 6.0e4, 3.0, 2.0e4, 4.0e-5
LEVELS = (1.5e-5, 5e-5, 1.2e-4, 2.5e-4, 4e-4)


def corners(X: float) -> complex:
    """Fundamental of a parallelogram, from its corners by the trapezoidal rule: no closed form of the package."""
    theta = 2.0 * math.pi * (np.arange(4000) + 0.5) / 4000
    x, z_0 = X * np.cos(theta), min(R_SLIP, X)
    back = np.maximum(x - X + z_0, -R_SLIP)
    forth = np.minimum(x + X - z_0, R_SLIP)
    force = K_Z * np.where(theta < math.pi, back, forth)
    return complex(2.0 * np.mean(force * np.exp(-1j * theta)) / X)


def power_law(X: float) -> complex:
    """A joint whose loss grows as X^2.6 and whose stiffness falls as X^0.6, from its branches by Masing's rule: sliders
    of all r with the force F = K_T x(1 − (x/x_0)^0.6) of the first loading."""
    theta = math.pi * (np.arange(2000) + 0.5) / 2000
    x = X * np.cos(theta)

    def first(u: np.ndarray) -> np.ndarray:
        return 1.2e4 * u * (1.0 - (u / 1.2e-3) ** 0.6)

    force = first(np.array(X)) - 2.0 * first(0.5 * (X - x))
    area = 2.0 * math.pi * float(np.mean(-force * X * np.sin(theta)))
    return complex(2.0 * float(np.mean(force * np.cos(theta))) / X, area / (math.pi * X**2))


def lines(joint: object, noise: float = 0.0, seed: int = 1, R: float = 0.0) -> StiffnessLines:
    """15 lines about resonance at each level, amplitudes as prescribed at its middle."""
    random, rows = np.random.default_rng(seed), []
    for level, largest in enumerate(LEVELS):
        middle = math.sqrt((K + joint(largest).real) / M)
        for step in np.linspace(-1.0, 1.0, 15):
            omega = middle * (1.0 + 0.01 * step)
            X = largest * (1.0 - 0.6 * step**2)
            Z = K - M * omega**2 + 1j * omega * C + joint(X)
            X_measured = X / abs(1.0 - R / (1.0 / Z + R))
            rows.append((omega, X_measured, 1.0 / (1.0 / Z + R), level))
    omega, X, Z, level = (np.array(column) for column in zip(*rows, strict=True))
    errors = random.standard_normal((2, Z.size)) * noise
    names = tuple(f"level {i + 1}" for i in range(len(LEVELS)))
    return StiffnessLines(omega, X, Z * (1.0 + errors[0] + 1j * errors[1]), level, names)


def one_slider(*of: object, **options: object):
    return fit_contact(lines(*of), contact="one slider", **options)


def loss_left(fit) -> float:
    """Root mean square of (loss of the law)/W − 1."""
    return fit.problem.misfit(fit.point).loss


def test_a_single_slider_is_recovered_exactly_without_noise():
    fit = one_slider(corners)
    found = [fit.value(name) for name in ("K_z", "F_k", "k", "m", "c")]
    # the trapezoidal rule errs by 1e-4 at the corners
    assert found == pytest.approx([K_Z, K_Z * R_SLIP, K, M, C], rel=1e-3)


def test_residual_receptance_is_recovered():
    R = -4e-6
    table = lines(corners, 0.003, R=R)
    fit = fit_contact(table, contact="one slider", residual=True)
    low, high = fit.interval("R")
    assert low < R < high
    assert high - low < 0.2 * abs(R)
    assert fit.value("F_k") == pytest.approx(K_Z * R_SLIP, rel=0.02)
    without = fit_contact(table, contact="one slider")
    assert loss_left(without) > 3.0 * loss_left(fit)


def test_a_gradual_contact_gives_loss_and_stiffness_in_range():
    fit = fit_contact(lines(power_law, 0.01), contact="gradual")
    X = np.geomspace(*fit.X_range, 7)
    omega = np.sqrt(fit.law(X, 0.0)[0].real / M)
    true = np.array([power_law(x) for x in X])
    assert fit.law(X, omega)[0].imag == pytest.approx(true.imag + omega * C, rel=0.04)
    assert fit.law(X, 0.0)[0].real == pytest.approx(K + true.real, rel=0.005)


def test_intervals_hold_what_they_say():
    held = []
    for seed in range(10):
        fit = one_slider(corners, 0.01, seed)
        true = {"F_k": K_Z * R_SLIP, "K_z": K_Z, "c": C, "k": K, "m": M}
        held += [low <= true[s] <= high for s in true for low, high in [fit.interval(s)]]
    # 10 draws of five intervals of 95 %, which depend on each other: 47 ± 3 of 50
    assert sum(held) >= 41
    assert fit.error("F_k") < 0.02 * fit.value("F_k")  # and not by being wide


@pytest.mark.parametrize(
    ("joint", "noise", "supported"),
    [
        (corners, 0.01, "one slider"),
        (power_law, 0.003, "gradual"),
        # loss that grows by damping is told from a contact by the stiffness
        (lambda X: 1j * 2e6 * X, 0.003, "none (c, c_2)"),
    ],
)
def test_comparison_finds_the_contact(joint, noise, supported):
    found = compare_contacts(lines(joint, noise))
    assert found.supported == supported
    assert found.weights[supported] > 0.9


def test_slip_far_below_the_amplitudes_gives_a_lower_limit_of_K_z():
    rigid = one_slider(lambda X: 4j * 0.05 / (math.pi * X), 0.01)
    low, high = rigid.interval("K_z")
    assert high == math.inf
    assert low > 0.05 / LEVELS[0]
    assert rigid.value("F_k") == pytest.approx(0.05, rel=0.02)


def test_a_stated_error_counts_and_grows_where_lines_scatter_more():
    noisy, widths = lines(corners, 0.01), []
    for error in (0.001, 0.01, 0.05):
        stated = replace(noisy, error=np.full(noisy.X.size, error))
        widths.append(fit_contact(stated, contact="one slider").error("F_k"))
    assert widths[0] == pytest.approx(widths[1], rel=0.25)
    assert widths[2] > 3.0 * widths[1]


TABLE = lines(corners)
AT_ONE = StiffnessLines(np.full(5, 200.0), TABLE.X[:5], TABLE.Z[:5], TABLE.level[:5], ("a",))
TWO = replace(TABLE, level=TABLE.level % 2, names=("a", "b"))


@pytest.mark.parametrize(
    ("refused", "message"),
    [
        (
            lambda: one_slider(corners).law(np.array([1.0]), 200.0),
            r"fitted to amplitudes from.*measure",
        ),
        (lambda: fit_contact(replace(AT_ONE, X=np.full(5, 4e-4)), contact="gradual"), "add levels"),
        (lambda: fit_contact(AT_ONE, contact="gradual"), r"too few.*add lines"),
        (lambda: fit_contact(AT_ONE, contact="one slider"), "do not separate k, m"),
        (lambda: compare_contacts(TWO), "add levels"),
        (lambda: fit_contact(TABLE, contact="none", terms=("F_k",)), "one slider"),
        (lambda: fit_contact(TABLE, contact="none", terms=("c_r",)), "use c"),
        (lambda: fit_contact(TABLE, contact="none", terms=("eta",)), "state stiffness"),
    ],
)
def test_refusals_say_what_to_do(refused, message):
    with pytest.raises(ValueError, match=message):
        refused()
