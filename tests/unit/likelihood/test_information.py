"""The Cramér–Rao bound against textbook cases and its own laws."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from dampbalance.likelihood.derivatives import compliance_root, response
from dampbalance.likelihood.information import (
    NotIdentifiable,
    assemble,
    channel_terms,
    covariance_of_K_z,
    cramer_rao,
    inverse,
    noise_of_rms,
)
from dampbalance.model import BaseMotion, Oscillator
from dampbalance.motion.orbit import steady_orbit
from paper_case import LEVELS, OMEGA, PAPER, motions_at

MOTIONS = motions_at()
ALL = ["y", "x", "v", "acceleration"]
TAU = np.linspace(-0.45, 0.45, 1201)


def bound(osc=PAPER, motions=MOTIONS, noise=None, rate_hz=2000.0, cycles=10.0, free=()):
    noise = noise or {"y": 5e-5, "x": 5e-5}
    return cramer_rao(osc, motions, rate_hz=rate_hz, cycles=cycles, noise=noise, free=free)


# --- derivatives of the waveform -----------------------------------------------------------------


def linear(osc, Y, psi, omega, tau):
    """x, ẋ, ẍ of the linear oscillator without friction."""
    H = osc.k / (osc.k - osc.m * omega**2 + 1j * osc.c * omega)
    return [(Y * H * (1j * omega) ** n * np.exp(1j * (omega * tau + psi))).real for n in (0, 1, 2)]


def test_derivatives_by_c_m_Y_psi_and_omega_without_friction():
    """F_k = 0: x = Re[Y H e^{i(ωτ+ψ)}], whose derivatives are elementary."""
    osc = replace(PAPER, F_k=0.0)
    Y, psi = 0.008, 0.7
    found = response(osc, BaseMotion(Y, OMEGA), psi, TAU, ALL, ("m", "omega"))
    D = osc.k - osc.m * OMEGA**2 + 1j * osc.c * OMEGA
    x = Y * osc.k / D * np.exp(1j * (OMEGA * TAU + psi))
    for order, name in enumerate(("x", "v", "acceleration")):
        u = (1j * OMEGA) ** order * x
        expected = {
            1: -u * 1j * OMEGA / D,  # c
            3: u * OMEGA**2 / D,  # m
            4: u / Y,
            5: 1j * u,  # ψ
            6: u * (1j * TAU + order / OMEGA + (2.0 * osc.m * OMEGA - 1j * osc.c) / D),  # ω
        }
        assert found.values[name] == pytest.approx(u.real, abs=1e-13 * np.abs(u).max())
        for row, derivative in expected.items():
            # Central differences of step 2e-5: 4e-10 of truncation, and 1e-15/2e-5 of rounding, times ten or so.
            size = np.abs(derivative).max()
            assert found.jacobian[name][row] == pytest.approx(derivative.real, abs=1e-8 * size)
    assert found.jacobian["y"][4] == pytest.approx(np.cos(OMEGA * TAU + psi), abs=1e-15)
    assert found.jacobian["y"][6] == pytest.approx(-Y * TAU * np.sin(OMEGA * TAU + psi), abs=1e-15)
    assert not found.jacobian["y"][:4].any()


def test_derivatives_are_those_of_the_signals():
    """Every row against differences of the signals themselves with a step 50 times as long, away from the jumps."""
    free, psi, h = ("m", "omega"), 0.4, 1e-3
    motion = BaseMotion(0.008, OMEGA)
    found = response(PAPER, motion, psi, TAU, ALL, free)
    p = [PAPER.F_k, PAPER.c, compliance_root(PAPER.K_z), PAPER.m, motion.Y, psi, OMEGA]

    def signals(p):
        osc = Oscillator(p[3], p[1], PAPER.k, p[2] ** -2, p[0])
        orbit = steady_orbit(osc, BaseMotion(p[4], p[6]))
        state = orbit.state((p[6] * TAU + p[5]) / p[6])
        return {"x": state.x, "v": state.v, "acceleration": state.acceleration}

    for row in range(7):
        low, high = list(p), list(p)
        low[row] -= h * p[row]
        high[row] += h * p[row]
        below, above = signals(low), signals(high)
        for name in ("x", "v", "acceleration"):
            difference = (above[name] - below[name]) / (high[row] - low[row])
            error = np.abs(difference - found.jacobian[name][row])
            # Truncation of the longer step, up to (1e-3 · 13 rad)² for ω; the 2 % nearest slip onset average a jump.
            assert np.quantile(error, 0.95) < 1e-3 * np.abs(difference).max(), (row, name)


@pytest.mark.parametrize("K_z", [1e7, 1e9, 1e11])
def test_the_rigid_limit_is_regular_in_the_root_of_the_compliance(K_z):
    """∂x/∂ρ tends to a limit: between stiffnesses a hundred times apart it changes ever less, as ρ falls tenfold."""
    motion = BaseMotion(0.008, OMEGA)

    def slope(K_z):
        osc = replace(PAPER, K_z=K_z)
        return response(osc, motion, 0.0, TAU, ["x"]).jacobian["x"][2]

    rigid = slope(1e13)
    change = np.abs(slope(K_z) - rigid).max() / np.abs(rigid).max()
    # First order in ρ, relative to that of K_z = 1e7 (0.3 ms of stick out of 200 ms).
    assert change < 0.05 * math.sqrt(1e7 / K_z)


# --- the bound -----------------------------------------------------------------------------------


def test_without_friction_c_has_the_textbook_bound():
    """Without friction x and y are sinusoids, and c alone, with Y and ψ, is unknown: the block of I without F_k, ρ."""
    osc = replace(PAPER, F_k=0.0)
    motion, sigma, n = BaseMotion(0.008, OMEGA), 4e-5, 1200
    t = np.arange(n) * motion.period / 100.0  # twelve whole cycles
    J = response(osc, motion, 0.0, t, ["y", "x"]).jacobian
    rows = [1, 3, 4]  # c, Y, ψ
    information = sum(J[name][rows] @ J[name][rows].T for name in ("y", "x")) / sigma**2
    variance = np.linalg.inv(information)[0, 0]
    # The lines ŷ, x̂ have the variance 2σ²/n in each part. D = k − mω² + icω = kŷ/x̂, so that c = Im(kŷ/x̂)/ω and
    # var c = (|k/X|² + |D/X|²) (2σ²/n)/ω². That Re D is known does not help: the error of kŷ/x̂ is circular, its parts
    # are uncorrelated.
    D = osc.k - osc.m * OMEGA**2 + 1j * osc.c * OMEGA
    X = osc.k * motion.Y / abs(D)
    textbook = (osc.k**2 + abs(D) ** 2) / X**2 * 2.0 * sigma**2 / n / OMEGA**2
    assert variance == pytest.approx(
        textbook, rel=1e-6
    )  # differences: 1e-8; twelve whole cycles: exact


def test_variances_go_with_noise_squared_and_one_over_samples():
    one = bound()
    loud = bound(noise={"y": 1.5e-4, "x": 1.5e-4})
    assert loud.covariance == pytest.approx(9.0 * one.covariance, rel=1e-10)  # rounding of I⁻¹
    long = bound(cycles=80.0)
    # Which phases are sampled changes with the length of the record: 1/(samples per cycle) at most.
    assert long.covariance == pytest.approx(one.covariance / 8.0, rel=3e-3)
    assert long.samples == pytest.approx(8 * one.samples, abs=40)


def test_an_offset_costs_what_it_takes_as_one_more_unknown():
    """Centred sums against the information with a column of ones for the offset, over two thirds of a cycle."""
    tau = np.linspace(-0.07, 0.07, 301)
    J = response(PAPER, MOTIONS[2], 0.3, tau, ["x"]).jacobian["x"]
    with_ones = np.vstack([J, np.ones(tau.size)])
    expected = (
        J @ J.T - np.outer(J.sum(axis=1), J.sum(axis=1)) / tau.size
    )  # Schur complement of the ones
    square = channel_terms(J, np.ones(tau.size)).square
    scale = np.sqrt(np.outer(np.diag(square), np.diag(square)))
    assert square / scale == pytest.approx(expected / scale, abs=1e-12)  # rounding
    inverse = np.linalg.inv(with_ones @ with_ones.T)
    # Condition number of the five unknowns and the offset, 1e10 or so after scaling, times rounding.
    assert np.diag(np.linalg.inv(square)) == pytest.approx(np.diag(inverse)[:-1], rel=1e-4)


@pytest.mark.parametrize("cycles", [1.3, 2.75])
def test_records_begin_at_the_peak_of_the_base(cycles):
    """Of no whole number of cycles, and with a σ of its own for each of two levels."""
    motions, sigmas, rate = MOTIONS[1:4:2], {"y": 5e-5, "x": (2e-5, 7e-5)}, 500.0
    terms, weights = [], []
    for motion, sigma in zip(motions, sigmas["x"], strict=True):
        t = np.arange(round(rate * cycles * motion.period)) / rate
        J = response(PAPER, motion, 0.0, t, ["y", "x"]).jacobian
        terms.append({name: channel_terms(J[name], np.zeros(t.size)) for name in J})
        weights.append({"y": 5e-5**-2, "x": sigma**-2})
    expected = covariance_of_K_z(inverse(assemble(terms, weights, 3)[0]), PAPER.K_z)
    found = bound(motions=motions, noise=sigmas, rate_hz=rate, cycles=cycles)
    # differences at other places in time: 1e-8 of a derivative, times the condition of I
    assert found.covariance == pytest.approx(expected, rel=1e-4)
    parts = np.array(found.relative) * (PAPER.F_k, PAPER.c, PAPER.K_z)
    assert parts == pytest.approx(found.standard_errors, rel=1e-15)
    assert bound(replace(PAPER, c=0.0), motions).relative[1] == math.inf


def test_dense_sampling_is_the_limit():
    """n samples that share out evenly over the phases: I = n ⟨(∂u/∂p)(∂u/∂p)ᵀ⟩/σ², the mean over one cycle."""
    sampled = bound(rate_hz=50000.0, cycles=3.0)
    phases = (np.arange(4096) + 0.5) / 4096
    weight = sampled.samples / 5 / 4096 / 5e-5**2
    terms = []
    for motion in MOTIONS:
        J = response(PAPER, motion, 0.0, phases * motion.period, ["y", "x"]).jacobian
        terms.append({name: channel_terms(J[name], phases) for name in J})
    dense = inverse(assemble(terms, [dict.fromkeys(sums, weight) for sums in terms], 3)[0])
    # 10,163 samples per cycle, and 4096 phases: both stand for the mean over the cycle.
    expected = covariance_of_K_z(dense, PAPER.K_z)
    assert sampled.covariance == pytest.approx(expected, rel=1e-3)


def test_bound_does_not_depend_on_the_units():
    """Lengths in mm: m, c, k, K_z in N/mm and the like, forces as they are."""
    mm = Oscillator(*(getattr(PAPER, n) / 1e3 for n in ("m", "c", "k", "K_z")), PAPER.F_k)
    motions = [BaseMotion(1e3 * Y, OMEGA) for Y in LEVELS]
    scaled = bound(mm, motions, {"y": 5e-2, "x": 5e-2})
    # Rounding of the differences, 1e-8 or so of a derivative.
    assert scaled.relative == pytest.approx(bound().relative, rel=1e-6)


def test_more_unknowns_cost_and_more_channels_help():
    known, free = bound(), bound(free=("m", "omega"))
    assert np.all(np.linalg.eigvalsh(free.covariance - known.covariance) > -1e-12)
    assert free.standard_errors[2] > 1.2 * known.standard_errors[2]  # K_z and m both add stiffness
    assert known.m_standard_error == 0.0 < free.m_standard_error
    noise = noise_of_rms(PAPER, MOTIONS, 0.01, ["y", "x", "acceleration"])
    fewer = {name: noise[name] for name in ("y", "x")}
    helped = bound(noise=noise).standard_errors[2]
    assert helped < 0.25 * bound(noise=fewer).standard_errors[2]  # slip onset shows in ẍ


def test_several_frequencies_add_their_information():
    other = motions_at(11.1)
    both = np.linalg.inv(bound(motions=MOTIONS + other).covariance)
    apart = sum(np.linalg.inv(bound(motions=m).covariance) for m in (MOTIONS, other))
    assert both == pytest.approx(apart, rel=1e-8)  # rounding of I⁻¹


def test_noise_of_rms_is_a_part_of_each_clean_channel():
    noise = noise_of_rms(PAPER, MOTIONS, 0.01, ["y", "v"])
    assert noise["y"] == pytest.approx([0.01 * Y / math.sqrt(2.0) for Y in LEVELS], rel=1e-12)
    orbit = steady_orbit(PAPER, MOTIONS[2])
    # b = ∮ ẋ² dt is the mean square times the period; 4096 phases of a function with kinks in its slope.
    assert noise["v"][2] == pytest.approx(0.01 * math.sqrt(orbit.b / orbit.motion.period), rel=1e-6)


def test_what_cannot_be_known_or_makes_no_sense_is_refused():
    with pytest.raises(NotIdentifiable, match="nothing slips"):
        bound(replace(PAPER, F_k=60.0))
    with pytest.raises(ValueError, match=r"unknown names \['z'\]"):
        bound(noise={"z": 1.0})
    with pytest.raises(ValueError, match=r"unknown names \['k'\]"):
        bound(free=("k",))
    with pytest.raises(ValueError, match="noise of 'x' must be positive"):
        bound(noise={"y": 1e-5, "x": 0.0})
    with pytest.raises(ValueError, match="has 2 values for 5 records"):
        bound(noise={"y": [1e-5, 1e-5], "x": 1e-5})
    with pytest.raises(ValueError, match="are 1 samples"):
        bound(cycles=1.0, rate_hz=5.0)
