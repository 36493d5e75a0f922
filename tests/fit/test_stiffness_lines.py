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


def loss_left(fit) -> float:
    """Root mean square of (loss of the law)/W − 1."""
    return fit.problem.misfit(fit.point).loss


def test_a_single_slider_is_recovered_exactly_without_noise():
    fit = fit_contact(lines(corners), contact="one slider")
    assert fit.value("K_z") == pytest.approx(
        K_Z, rel=1e-3
    )  # the trapezoidal rule errs by 1e-4 at the corners
    assert fit.value("F_k") == pytest.approx(K_Z * R_SLIP, rel=1e-3)
    assert [fit.value(name) for name in ("k", "m", "c")] == pytest.approx([K, M, C], rel=1e-3)


def test_residual_receptance_is_recovered():
    R = -4e-6
    fit = fit_contact(lines(corners, 0.003, R=R), contact="one slider", residual=True)
    low, high = fit.interval("R")
    assert low < R < high
    assert high - low < 0.2 * abs(R)
    assert fit.value("F_k") == pytest.approx(K_Z * R_SLIP, rel=0.02)
    without = fit_contact(lines(corners, 0.003, R=R), contact="one slider")
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
    for seed in range(20):
        fit = fit_contact(lines(corners, 0.01, seed), contact="one slider")
        true = {"F_k": K_Z * R_SLIP, "K_z": K_Z, "c": C, "k": K, "m": M}
        held += [low <= true[s] <= high for s in true for low, high in [fit.interval(s)]]
    # 20 draws of five intervals of 95 %, which depend on each other: 95 ± 5 of 100
    assert sum(held) >= 85
    assert fit.error("F_k") < 0.02 * fit.value("F_k")  # and not by being wide


def test_comparison_finds_one_slider_and_the_gradual_contact():
    one = compare_contacts(lines(corners, 0.01))
    assert one.supported == "one slider"
    assert one.weights["one slider"] > 0.9
    many = compare_contacts(lines(power_law, 0.003))
    assert many.supported == "gradual"
    assert many.weights["one slider"] < 1e-6
    assert loss_left(many.fits["one slider"]) > loss_left(many.fits["gradual"])


def test_loss_that_grows_by_damping_is_told_from_a_contact_by_the_stiffness():
    nothing = compare_contacts(lines(lambda X: 1j * 2e6 * X, 0.003))
    assert nothing.supported == "none (c, c_2)"


def test_slip_far_below_the_amplitudes_gives_a_lower_limit_of_K_z():
    rigid = fit_contact(lines(lambda X: 4j * 0.05 / (math.pi * X), 0.01), contact="one slider")
    low, high = rigid.interval("K_z")
    assert high == math.inf
    assert low > 0.05 / LEVELS[0]
    assert rigid.value("F_k") == pytest.approx(0.05, rel=0.02)


def test_a_stated_error_counts_and_grows_where_lines_scatter_more():
    noisy = lines(corners, 0.01)
    widths = []
    for error in (0.001, 0.01, 0.05):
        stated = StiffnessLines(
            *(noisy.omega, noisy.X, noisy.Z, noisy.level, noisy.names), np.full(noisy.X.size, error)
        )
        widths.append(fit_contact(stated, contact="one slider").error("F_k"))
    assert widths[0] == pytest.approx(widths[1], rel=0.25)
    assert widths[2] > 3.0 * widths[1]


def test_the_same_lines_give_the_same_bytes():
    first, second = (fit_contact(lines(power_law, 0.01), contact="gradual") for _ in range(2))
    assert first.point.tobytes() == second.point.tobytes()
    assert first.interval("K_z") == second.interval("K_z")


def test_given_coefficients_and_stiffness_are_kept():
    fit = fit_contact(lines(corners, 0.003), contact="gradual", given={"c": C}, stiffness=K, mass=M)
    assert (fit.value("c"), fit.value("k"), fit.value("m")) == (C, K, M)
    assert fit.error("c") == 0.0
    assert fit.law(np.array([5e-5]), 0.0)[0].real == pytest.approx(
        [K + corners(5e-5).real], rel=0.005
    )


def test_refusals_say_what_to_do():
    table = lines(corners)
    fit = fit_contact(table, contact="one slider")
    with pytest.raises(ValueError, match=r"fitted to amplitudes from.*measure there"):
        fit.law(2.0 * np.array(fit.X_range), 200.0)
    at_one = StiffnessLines(np.full(5, 200.0), table.X[:5], table.Z[:5], table.level[:5], ("a",))
    with pytest.raises(ValueError, match=r"alike.*add levels"):
        fit_contact(replace(at_one, X=np.full(5, 4e-4)), contact="gradual")
    with pytest.raises(ValueError, match=r"too few.*add lines"):
        fit_contact(at_one, contact="gradual")
    with pytest.raises(ValueError, match="do not separate k, m"):
        fit_contact(at_one, contact="one slider")
    two = StiffnessLines(table.omega, table.X, table.Z, table.level % 2, ("a", "b"))
    with pytest.raises(ValueError, match="add levels"):
        compare_contacts(two)
    for terms, words in (("F_k", "one slider"), ("c_r", "use c"), ("eta", "state stiffness")):
        with pytest.raises(ValueError, match=words):
            fit_contact(table, contact="none", terms=(terms,))
