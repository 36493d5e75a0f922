"""Oscillators from which a fit to steady records starts: those that balance the work of the records.

For each contact stiffness of a grid the energy balance of the records,

    W = −πkY Im x_1 = 4(X − F_k/K_z) F_k + πω Σ n²|x_n|² c

gives F_k and c, by least squares and for several shares of friction in the work (a single level does not separate the
two), and the in-phase part of the fundamental the mass:

    mω² = k + K − kY Re(1/x_1),   K = K_z Re D(Z_m/X)

with the stiffness K that the contact has for the fundamental of a harmonic motion, and D of `law/contact.py`. The
responses of these candidates to the force that the contact has in the motion as it was read, which need no orbit, are
compared with the harmonics, and the closest start; where no fit from there holds, those of many more candidates.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ..arrays import Array, Complexes, Mask
from ..law.contact import describing, play
from ..law.terms import FRICTION, term
from ..signals.record_harmonics import RecordHarmonics

_STIFFNESSES = np.geomspace(0.1, 1e5, 19)  # of K_z/k
# How many of them, up to 1,000: stiffer ones rattle, and a climb reaches them from there, in 1/√K_z.
_SOFTEST = 13
_SHARES = (0.03, 0.2, 0.5, 0.8, 0.97)  # of friction in the work
_RATIOS = np.geomspace(0.25, 8.0, 21)  # of the natural frequency to that of the drive
_COMPARED_HARMONICS = (1, 3, 5)
_POINTS_OF_CONTACT = 256  # of a cycle, for the force of a contact
_MORE = 1.0 + 1e-13  # of the diagonal of normal equations: they are then not singular
_NEAR_FUNDAMENTAL = 0.03  # of the fundamental: what a candidate may be off by


class Shares(NamedTuple):
    """Shares of F_k and of c that act in each record, (n,): normal loads differ, and so do amplitudes, with which
    nonlinear damping grows."""

    friction: Array
    damping: Array


def starts(
    lines: Sequence[RecordHarmonics], k: float, shares: Shares | None = None, *, wide: bool = False
) -> Array:
    """Return (F_k, c, K_z, m) of oscillators that respond like the records, (n, 4), the closest first; each slips in
    one.

    k : N/m.   shares : of F_k and of c that each record has; default, all of both.   wide : the closest of
    each contact stiffness, with masses over three decades in addition to those that follow from the fundamental,
    which hardly depends on the mass far below resonance.
    """
    shares = shares or Shares(np.ones(len(lines)), np.ones(len(lines)))
    candidates = _candidates(lines, k, shares, wide)
    if not len(candidates):
        return candidates
    harmonics, slips = _responses_to_contact(candidates, lines, k, shares)
    misfit = np.zeros(len(candidates))
    for i, one in enumerate(lines):
        near = _NEAR_FUNDAMENTAL * abs(one.x[0])
        for j, (n, x, error) in enumerate(
            zip(_COMPARED_HARMONICS, one.x, one.x_error, strict=False)
        ):
            off = np.abs(harmonics[:, i, j] - x) ** 2
            misfit += off / (error**2 + (near / n) ** 2)
    order = np.argsort(misfit, kind="stable")
    best = candidates[order[(slips & np.isfinite(misfit))[order]]]
    if wide:  # the closest of each stiffness: a contact that rings has a minimum at many
        best = best[np.sort(np.unique(best[:, 2], return_index=True)[1])]
    return best


def _responses_to_contact(
    candidates: Array, lines: Sequence[RecordHarmonics], k: float, shares: Shares
) -> tuple[Complexes, Mask]:
    """Return x_1, x_3, x_5 of each candidate under the base of each record, (n, L, 3), m, and which slip in one of
    them: x_n = (kY δ_n1 − f_n)/(k − n²ω²m + inωc) with the harmonics f_n of the force K_z z that the contact has in the
    motion as it was read, which needs no orbit."""
    F_k, c, K_z, m = candidates.T
    n = np.array(_COMPARED_HARMONICS)
    turn = np.exp((-2j * math.pi / _POINTS_OF_CONTACT) * np.outer(n, np.arange(_POINTS_OF_CONTACT)))
    harmonics, slips = [], []
    for one, rubbed, damped in zip(lines, *shares, strict=True):
        Z_m = rubbed * F_k / K_z
        cycle = _waveform(one)
        wave = np.concatenate([cycle, cycle])  # the second cycle is steady
        z = play(wave, Z_m)[:, _POINTS_OF_CONTACT:].T
        force = (2.0 / _POINTS_OF_CONTACT) * K_z * (turn.real @ z + 1j * (turn.imag @ z))
        drive = np.where(n == 1, k * one.Y, 0.0)
        impedance = k - np.outer((n * one.omega) ** 2, m) + 1j * np.outer(n * one.omega, damped * c)
        harmonics.append(((drive[:, None] - force) / impedance).T)
        slips.append(np.ptp(wave) > 2.0 * Z_m)
    return np.stack(harmonics, axis=1), np.any(slips, axis=0)


def _waveform(one: RecordHarmonics) -> Array:
    """Return the displacement over a cycle from the peak of the base, by the harmonics that stand out of the noise,
    m."""
    spectrum, taken = np.zeros(_POINTS_OF_CONTACT // 2 + 1, dtype=np.complex128), one.clear
    taken &= one.n < spectrum.size - 1
    spectrum[one.n[taken]] = 0.5 * _POINTS_OF_CONTACT * one.x[taken]
    return np.fft.irfft(spectrum, _POINTS_OF_CONTACT)


def _candidates(lines: Sequence[RecordHarmonics], k: float, shares: Shares, wide: bool) -> Array:
    """Return the (F_k, c, K_z, m) that balance the work, (n, 4)."""
    fundamental = np.array([one.x[0] for one in lines])
    omega, Y, X, b = np.array([(one.omega, one.Y, *_peak_and_viscous(one)) for one in lines]).T
    W = -math.pi * k * Y * fundamental.imag
    b = b * shares.damping
    known = W > 0.0  # noise may hide the work of a low level
    if not known.any():
        return np.empty((0, 4))
    # axes: contact stiffness, share of friction in the work (of the first, that which fits the levels best), record
    K_z = k * (_STIFFNESSES[:_SOFTEST] if wide else _STIFFNESSES)[:, None, None]
    rubbed, work = shares.friction[known], W[known]
    F_k = np.zeros((K_z.size, 1 + len(_SHARES), 1))
    for _ in range(8):  # the travel a depends on F_k through Z_m
        slid = np.maximum(X[known] - F_k * rubbed / K_z, 0.0)
        slid = np.where(slid.any(axis=-1, keepdims=True), slid, 0.05 * X[known])
        a = 4.0 * rubbed * slid
        F_k = work.sum() / a.sum(axis=-1, keepdims=True) * [[1.0], *([part] for part in _SHARES)]
        F_k[:, 0], of_c = _not_negative(a[:, 0] / work, b[known] / work)
    c = np.tile(work.sum() / b[known].sum() * (1.0 - np.array([1.0, *_SHARES])), (K_z.size, 1))
    c[:, 0] = of_c[:, 0]
    contact = K_z * describing(F_k * shares.friction / (K_z * X)).real
    apparent = k - (k * Y / fundamental).real
    m = np.sum((apparent + contact) / omega**2 * X**2, axis=-1, keepdims=True) / np.sum(X**2)
    if wide:
        others = np.broadcast_to(k / (float(omega.max()) * _RATIOS) ** 2, (*c.shape, _RATIOS.size))
        m = np.concatenate([m, others], axis=-1)
    candidates = np.stack(np.broadcast_arrays(F_k, c[..., None], K_z, m), axis=-1).reshape(-1, 4)
    rows: Array = candidates[(candidates[:, 0] > 0.0) & (candidates[:, 3] > 0.0)]
    return rows


def _not_negative(a: Array, b: Array) -> tuple[Array, Array]:
    """Return the two non-negative numbers with which each row of a, and b, (…, L), together are closest to ones; (…,
    1)."""
    columns = np.stack(np.broadcast_arrays(a, b), axis=-1)
    (aa, bb), ab = np.moveaxis(np.sum(columns**2, axis=-2), -1, 0), np.sum(a * b, axis=-1)
    of_a, of_b = np.moveaxis(np.sum(columns, axis=-2), -1, 0)
    aa, bb = aa * _MORE, bb * _MORE  # of levels that are alike, each takes a half
    right = [of_a * bb - of_b * ab, of_b * aa - of_a * ab]
    solved = np.stack(right, axis=-1) / (aa * bb - ab**2)[..., None]
    alone = np.stack([of_a / aa, of_b / bb], axis=-1)  # each without the other
    left = np.linalg.norm(columns * alone[..., None, :] - 1.0, axis=-2)
    only = np.where(left[..., :1] <= left[..., 1:], [1.0, 0.0], [0.0, 1.0]) * alone
    found = np.where((solved >= 0.0).all(axis=-1, keepdims=True), solved, only)
    return found[..., :1], found[..., 1:]


def _peak_and_viscous(one: RecordHarmonics) -> tuple[float, float]:
    """Return (X, b) of the harmonics that stand out of the noise, m and m²/s."""
    x = np.where(one.clear, one.x, 0.0)
    squares = np.maximum(np.abs(x) ** 2 - 2.0 * one.x_error**2, 0.0)
    return float(np.max(_waveform(one))), math.pi * one.omega * float(squares @ one.n**2)


def equivalent_coefficient(symbol: str, one: RecordHarmonics, k: float) -> float:
    """Return the coefficient of a term that dissipates about as much in a record as a damper of 1 N s/m, from its
    fundamental."""
    if symbol == FRICTION:
        return 1.0
    X = abs(one.x[0])
    viscous: float = math.pi * one.omega * X**2
    return viscous / float(term(symbol).harmonic(one.omega, X, 0.0, 0.0, k))
