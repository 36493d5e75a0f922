"""Preparation of the samples of a channel: resampling to even steps, leading samples, sampling interval."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from ..arrays import Array
from ..project.wording import visible
from ..records.measurement import Channel
from .cycles import Samples

_JITTER = 0.05  # of a step: times closer to an even grid than that are on it


def evenly_sampled(channel: Channel, source: str, warnings: list[str]) -> Channel:
    """The channel itself, or resampled by a cubic spline when its samples are unevenly spaced (gaps apart)."""
    steps = np.diff(channel.t)
    dt = float(np.median(steps))
    odd = np.abs(steps / dt - np.round(steps / dt)) > 2.0 * _JITTER
    if odd.mean() < 0.01:
        return channel
    from scipy.interpolate import CubicSpline  # rarely needed, slow to import

    name = visible(channel.name)
    if channel.t.size < 8:
        raise ValueError(f"{source}: {name} has only {channel.t.size} samples")
    gap = float(steps.max())
    if gap > 20.0 * dt:
        raise ValueError(
            f"{source}: {name} is unevenly sampled and has a gap of {gap:.3g} s after "
            f"{channel.t[int(np.argmax(steps))]:.6g} s; cut the record there"
        )
    spline = CubicSpline(channel.t, channel.values)
    t = np.arange(channel.t[0], channel.t[-1], dt)
    coarse = CubicSpline(channel.t[::2], channel.values[::2])(channel.t[1:-1:2])
    error = float(np.sqrt(np.mean((coarse - channel.values[1:-1:2]) ** 2))) / 16.0
    warnings.append(
        f"{name}: unevenly sampled (steps of {steps.min():.3g} to {gap:.3g} s), resampled every {dt:.3g} s by "
        f"a cubic spline; error about {error:.2g} {channel.unit} in addition to the noise"
    )
    return Channel(channel.quantity, t, spline(t), channel.name)


def leading_samples(blocks: Iterable[Samples], count: int) -> Samples:
    """The first samples of a channel, at least `count` of them if there are as many."""
    first = np.zeros((2, 0))
    for block in blocks:
        room = count - first.shape[1]
        first = np.hstack([first, [samples[:room] for samples in block]])
        if first.shape[1] >= count:
            break
    if not first.size:
        raise ValueError("a channel has no samples")
    return first[0], first[1]


def step_of(t: Array, quantity: str) -> float:
    """Sampling interval, s: the mean over the steps that are no gaps."""
    if t.size < 3:
        raise ValueError(f"{quantity} has only {t.size} samples")
    steps = np.diff(t)
    return float(np.mean(steps[np.abs(steps - np.median(steps)) < 0.5 * np.median(steps)]))
