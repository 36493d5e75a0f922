"""What a record adds to the harmonics of a motion under a harmonic base: the motion that further harmonics of the base
cause.

The fit of an oscillator compares the harmonics of a record with those of the exact motion under y = Y cos ωt. What
differs because the base moves otherwise, Δ_n, follows from the oscillator itself and from the harmonics y_n of the
base, which are measured: by the exact motion under all of them (`motion/distorted.py`), not to first order. The fit is
made to x_n − Δ_n, Δ_n is computed anew for the oscillator found, and so on until it stays as it is: the residuals of
that fit are exact, its derivatives are those under the harmonic base.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from ..arrays import Array, Integers
from ..law.law import Law
from ..motion.law_steady import Response
from ..signals.lines import Lines
from ..signals.mean_harmonics import added_by_base
from .steady_search import climb_on, fit_oscillator, of_all_stiffnesses
from .waveforms import NO_MOTION, WaveformFit

MOST_REPETITIONS = 20
"""Repetitions: three or four do, but where a contact rings while it sticks."""

PATIENCE = 4
"""Repetitions with the end of first climbs that is not adequate, before a search elsewhere."""

_LEAST_FEEDBACK = 0.2  # of 1 − R: less, and the last step does not show it
_SEARCHES = 4  # along K_z
_STAYS = 0.02  # standard errors: a change that does not matter


def fit_records(
    lines: Sequence[Lines], k: float, law: Law | None = None, *, thorough: bool = True
) -> WaveformFit | None:
    """The oscillator of largest likelihood for records whose base need not be harmonic; arguments as for
    `fit_oscillator`, whose fit it is where the base is harmonic.

    The harmonics of the fit, `fit.lines`, are those of the records without what the harmonics of the base add.
    """
    plain = not any(one.base.any() for one in lines)
    fit = fit_oscillator(lines, k, law, thorough=thorough and plain)
    if plain or fit is None:
        return fit
    fit = settled(fit, lines, PATIENCE)
    if fit.adequate or not thorough:
        return fit
    # the first climbs may have led elsewhere, misled by the harmonics of the base
    again = fit_oscillator(fit.lines, k, law)
    fit = min((fit, settled(again or fit, lines)), key=lambda one: one.chi_square)
    for _ in range(0 if fit.adequate else _SEARCHES):
        # what the base adds depends on K_z, and so does which K_z is the best
        better = of_all_stiffnesses(fit)
        if better.chi_square >= fit.chi_square:
            break
        better = settled(better, lines)
        if better.chi_square >= fit.chi_square:
            break
        fit = better
    return fit


def settled(
    fit: WaveformFit, lines: Sequence[Lines], patience: int = MOST_REPETITIONS
) -> WaveformFit:
    """The fit to these harmonics without what the base of the fit's own oscillator adds to them; the fit itself where
    the base is harmonic. Use it after a fit that took the harmonics as they are, or those of another fit.

    patience : as for `repeated`.
    """
    if not any(one.base.any() for one in lines):
        return fit
    return repeated(fit, lambda responses: of_harmonic_base(lines, responses), patience) or fit


def of_harmonic_base(lines: Sequence[Lines], responses: Sequence[Response]) -> list[Lines]:
    """The harmonics without what those of the base add to the motion of an oscillator, one response for each record."""
    return [
        replace(one, x=one.x - added_by_base(one.base, response, one.n.size))
        if one.base.any()
        else one
        for one, response in zip(lines, responses, strict=True)
    ]


def repeated(
    fit: WaveformFit,
    freed: Callable[[Sequence[Response]], Sequence[Lines]],
    patience: int = MOST_REPETITIONS,
) -> WaveformFit | None:
    """The fit to harmonics that are freed of something which depends on the oscillator itself, again and again until it
    stays as it is; None where a climb fails.

    freed : the harmonics that the motions of an oscillator leave, one motion for each record.
    patience : repetitions after which a fit that is not adequate is given up as it is.

    The oscillator p that frees them should be the one, G(p), that fits them then. From the second time on p is where a
    line through the last two G(p) − p comes nearest to zero (Anderson's mixing).
    """
    at = fit.point
    steps: list[tuple[Array, Array]] = []
    for count in range(1, MOST_REPETITIONS + 1):
        try:
            responses = [fit.unknowns.response(at, i) for i in range(len(fit.lines))]
        except NO_MOTION:
            return None
        following = climb_on(fit, freed(responses))
        if following is None:
            return None
        fit, error = following, np.sqrt(np.diag(following.covariance))
        free = np.flatnonzero(error[: len(fit.names)])
        steps.append((at[free], fit.point[free]))
        off = (fit.point - at)[free] / error[free]
        if (np.abs(off) <= _STAYS).all() or (count >= patience and not fit.adequate):
            break
        at = fit.point.copy()
        if len(steps) > 1:
            (old, old_fit), (_, new_fit) = steps[-2:]
            turned = off - (old_fit - old) / error[free]
            part = float(off @ turned) / max(float(turned @ turned), 1e-300)
            at[free] = np.clip(new_fit - part * (new_fit - old_fit), 0.5 * new_fit, 2.0 * new_fit)
    return _fed_back(fit, free, steps)


def _fed_back(
    fit: WaveformFit, free: Integers, steps: Sequence[tuple[Array, Array]]
) -> WaveformFit:
    """The fit with the errors of the p = G(p) that it is: noise that moves p moves what is taken off as well, and G by
    R = ∂G/∂p of that, so that errors are those of the last climb times (1 − R)^{−1}. R is taken along the last step,
    and only where it makes the errors larger.

    free : places of the common unknowns that were fitted.   steps : p and G(p).
    """
    if len(steps) < 2:
        return fit
    error = np.sqrt(np.diag(fit.covariance))[free]
    moved, answered = ((steps[-1][i] - steps[-2][i]) / error for i in (0, 1))
    size, along = float(moved @ moved), float(moved @ answered)
    if not 0.0 < along < (1.0 - _LEAST_FEEDBACK) * size:
        return fit
    response = fit.response.copy()
    change = np.outer(error * answered, moved @ (response[free] / error[:, None]))
    response[free] += change / (size - along)
    return replace(fit, response=response, covariance=response @ response.T)
