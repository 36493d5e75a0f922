"""The information in records, sample by sample: slow, without harmonics, the yardstick of the bound."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from dampbalance.motion.orbit import steady_orbit

_STEP = 2e-5  # central differences: 1e-9 (F_k) to 1e-7 (ρ) of the rms of a derivative


def derivatives(osc, motion, t):
    """∂x/∂(F_k, c, ρ, m, Y, ψ) at the times t under y = Y cos(ωt + ψ), ψ = 0, (6, n), and those of y."""
    point = np.array([osc.F_k, osc.c, osc.K_z**-0.5, osc.m, motion.Y, 0.0])

    def x(p):
        moved = replace(osc, F_k=p[0], c=p[1], K_z=p[2] ** -2, m=p[3])
        return steady_orbit(moved, replace(motion, Y=p[4])).state(t + p[5] / motion.omega).x

    sizes = np.array([osc.F_k, osc.c, point[2], osc.m, motion.Y, 1.0])
    of_x = [(x(point + h) - x(point - h)) / (2.0 * h.sum()) for h in _STEP * np.diag(sizes)]
    of_y = np.zeros((6, t.size))
    of_y[4:] = np.cos(motion.omega * t), -motion.Y * np.sin(motion.omega * t)
    return np.array(of_x), of_y


def noise_of_rms(osc, motions, fraction):
    """Standard deviations of y and x that are a part of the rms of each clean channel, for each record."""
    phases = np.arange(4096) / 4096
    x = [steady_orbit(osc, motion).state(phases * motion.period).x for motion in motions]
    rms = {"y": [motion.Y / np.sqrt(2.0) for motion in motions], "x": np.std(x, axis=1)}
    return {name: fraction * np.array(sizes) for name, sizes in rms.items()}


def covariance(osc, motions, rate_hz, cycles, noise, free=()):
    """The bound on the covariance of (F_k, c, K_z[, m]) from Σ (∂u/∂p)(∂u/∂p)ᵀ/σ² over the samples of each channel; an
    unknown offset takes out the mean of each derivative."""
    size = 4 + 2 * len(motions)
    information = np.zeros((size, size))
    for i, motion in enumerate(motions):
        t = np.arange(round(rate_hz * cycles * motion.period)) / rate_hz
        place = [0, 1, 2, 3, 4 + 2 * i, 5 + 2 * i]
        for name, J in zip(("x", "y"), derivatives(osc, motion, t), strict=True):
            J = J - J.mean(axis=1, keepdims=True)
            sigma = np.broadcast_to(noise[name], len(motions))[i]
            information[np.ix_(place, place)] += J @ J.T / sigma**2
    kept = [j for j in range(size) if j != 3 or "m" in free]
    information = information[np.ix_(kept, kept)]
    scale = np.sqrt(np.diag(information))
    inverse = np.linalg.inv(information / np.outer(scale, scale)) / np.outer(scale, scale)
    common = 3 + len(free)
    turn = np.array([1.0, 1.0, -2.0 * osc.K_z**1.5, 1.0])[:common]  # dK_z/dρ
    return inverse[:common, :common] * np.outer(turn, turn)
