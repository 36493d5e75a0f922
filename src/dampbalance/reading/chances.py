"""Tails of the distributions of Gauss, Student and Fisher, and the quantile of Student's: the chances of noise.

`scipy.special` has them as well, but takes as long to import as five records take to identify. All are the incomplete
beta function,

    I_x(a, b) = x^a (1 − x)^b Γ(a + b)/(Γ(a + 1) Γ(b)) / (1 + d_1/(1 + d_2/(1 + …))),

    d_2m = m(b − m)x/((a + 2m − 1)(a + 2m)),    d_2m+1 = −(a + m)(a + b + m)x/((a + 2m)(a + 2m + 1))

(Abramowitz & Stegun 26.5.8), by Lentz's method, for x < (a + 1)/(a + b + 2); above it, I_x(a, b) = 1 − I_{1−x}(b, a).
With ν degrees of freedom the logarithms of Γ leave a relative error of about 10⁻¹⁵ν: nine digits hold up to a million.
"""

from __future__ import annotations

import math

_TINY = 1e-300  # instead of zero, in a denominator
_EXACT = 1e-15
_NEAR = 1e-9  # the next step is about its square


def normal_tail(z: float) -> float:
    """Probability that a standard normal number exceeds z."""
    return 0.5 * math.erfc(z / math.sqrt(2.0))


def f_tail(first: float, rest: float, ratio: float) -> float:
    """Probability that Fisher's F with (first, rest) degrees of freedom exceeds a ratio; NaN where one has none."""
    if not (first > 0.0 and rest > 0.0 and ratio >= 0.0):
        return math.nan
    part, whole = first * ratio, rest + first * ratio
    return _beta(0.5 * rest, 0.5 * first, rest / whole, part / whole) if part < math.inf else 0.0


def t_tail(freedom: float, t: float) -> float:
    """Probability that Student's t exceeds a number; normal where the degrees of freedom are infinite."""
    if math.isinf(freedom):
        return normal_tail(t)
    tail = 0.5 * f_tail(1.0, freedom, t * t)
    return tail if t >= 0.0 else 1.0 - tail


def t_quantile(freedom: float, chance: float) -> float:
    """The number that Student's t exceeds with a probability below a half, by Newton's method on the logarithm of its
    tail, which is nearly a straight line of ln t; NaN without a degree of freedom."""
    t, nu = 1.0, freedom
    if not nu > 0.0:
        return math.nan
    for _ in range(100):
        tail = t_tail(nu, t)
        if math.isinf(nu):
            density = math.exp(-0.5 * t * t) / math.sqrt(2.0 * math.pi)
        else:
            size = math.lgamma(0.5 * nu + 0.5) - math.lgamma(0.5 * nu)
            fallen = -0.5 * (nu + 1.0) * math.log1p(t * t / nu)
            density = math.exp(size + fallen) / math.sqrt(nu * math.pi)
        step = tail * math.log(tail / chance) / (density * t)
        t *= math.exp(min(max(step, -1.0), 1.0))
        if abs(step) < _NEAR:
            break
    return t


def _beta(a: float, b: float, x: float, rest: float) -> float:
    """I_x(a, b), rest = 1 − x."""
    if x > (a + 1.0) / (a + b + 2.0):
        return 1.0 - _beta(b, a, rest, x)
    if x == 0.0:
        return 0.0
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
    return math.exp(size + a * math.log(x) + b * math.log(rest)) / fraction
