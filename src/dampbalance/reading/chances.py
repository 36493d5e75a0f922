"""Tails of the distributions of Gauss, Student and Fisher, and the quantile of Student's: the chances of noise.

`scipy.special` has them as well, but takes a third as long to import as five records take to identify. All are the
incomplete beta function I_x(a, b), by its continued fraction (Abramowitz & Stegun 26.5.8) and Lentz's method. With ν
degrees of freedom the logarithms of Γ leave a relative error of about 10⁻¹⁵ν: nine digits hold up to a million.
"""

from __future__ import annotations

import math

_TINY, _VAST = 1e-300, 1e280  # instead of zero and of infinity
_EXACT = 1e-15
_SHORT, _NEAR = (
    1e-5,
    1e-11,
)  # of ln t: for the slope, and the last step, which leaves 1e-5 of itself


def normal_tail(z: float) -> float:
    """Probability that a standard normal number exceeds z."""
    return 0.5 * math.erfc(z / math.sqrt(2.0))


def f_tail(first: float, rest: float, ratio: float) -> float:
    """Probability that Fisher's F with (first, rest) degrees of freedom exceeds a ratio; NaN where one has none."""
    if not (first > 0.0 and rest > 0.0 and ratio >= 0.0):
        return math.nan
    part = first * min(ratio, _VAST)
    return _beta(0.5 * rest, 0.5 * first, rest / (rest + part), part / (rest + part))


def t_tail(freedom: float, t: float) -> float:
    """Probability that Student's t exceeds a number; normal where the degrees of freedom are infinite."""
    if math.isinf(freedom):
        return normal_tail(t)
    tail = 0.5 * f_tail(1.0, freedom, t * t)
    return tail if t >= 0.0 else 1.0 - tail


def t_quantile(freedom: float, chance: float) -> float:
    """The number that Student's t exceeds with a probability below a half, by Newton's method on ln tail against ln t,
    which is nearly a straight line."""
    at = 0.0
    for _ in range(100):
        off, later = (math.log(t_tail(freedom, math.exp(x)) / chance) for x in (at, at + _SHORT))
        step = _SHORT * off / (off - later)
        at += min(max(step, -1.0), 1.0)
        if not abs(step) > _NEAR:
            break
    return math.exp(at)


def _beta(a: float, b: float, x: float, rest: float) -> float:
    """I_x(a, b), rest = 1 − x."""
    if x > (a + 1.0) / (a + b + 2.0):
        return 1.0 - _beta(b, a, rest, x)
    fraction = above = 1.0
    below = 0.0
    for i in range(1, 100_000):
        m = i // 2
        d = -(a + m) * (a + b + m) if i % 2 else m * (b - m)
        d *= x / ((a + i - 1.0) * (a + i))
        below = 1.0 / ((1.0 + d * below) or _TINY)
        above = (1.0 + d / above) or _TINY
        fraction *= below * above
        if abs(below * above - 1.0) < _EXACT:
            break
    size = math.lgamma(a + b) - math.lgamma(a + 1.0) - math.lgamma(b)
    return math.exp(size + a * math.log(max(x, _TINY)) + b * math.log(rest)) / fraction
