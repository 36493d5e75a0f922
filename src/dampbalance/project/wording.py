"""Numbers in words, for pages that people read."""

from __future__ import annotations

import numpy as np

_RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def percent(share: float) -> str:
    """A share as a percentage with three significant digits; a bound where it is nothing but rounding."""
    if not np.isfinite(share):
        return "–"
    value = 100.0 * abs(share)
    if value < 1e-6:
        power = str(int(np.ceil(np.log10(value)))) if value else ""
        return f"10{power.translate(_RAISED)} %" if value else "0 %"
    exponent = int(np.floor(np.log10(value)))
    if not -3 <= exponent < 5:
        return f"{value / 10.0**exponent:.1f}·10{str(exponent).translate(_RAISED)} %"
    digits = max(0, 2 - exponent)
    if value < 100.0 <= round(value, digits):  # nearly all is not all
        digits = 2
    return f"{value:.{digits}f} %"
