"""How figures show a parameter, the same in all studies: lengths in mm, noise in %, and a frequency as ω/ω_n."""

from __future__ import annotations

import math
from typing import NamedTuple

from ...project.wording import label_with_unit
from ..parameters import parameter
from ..study_file import Study

_SHOWN_IN = {"m": (1e3, "mm")}  # unit → factor, unit of figures
_RATIO, _HERTZ = "omega_over_omega_n", "frequency_hz"


class ShownAs(NamedTuple):
    """How a parameter is shown.

    factor : by which its values are multiplied.   name, label : its symbol or meaning, and the same with the unit, for
    an axis.   unit : of what is shown.   natural : frequency of all cases, Hz, next to which a frequency is shown; else
    NaN.
    """

    factor: float
    name: str
    label: str
    unit: str
    natural: float = math.nan

    def titled(self, value: float | str) -> str:
        """Return a value for the title of a panel, K_z/k = 90, ω/ω_n = 0.712 (3.5 Hz); a word alone."""
        if isinstance(value, str):
            return value
        shown = self.factor * value
        if math.isfinite(self.natural):
            return f"{self.name} = {shown:.3g} ({shown * self.natural:.3g} Hz)"
        mark = " =" if self.name.startswith("$") else ":"
        return f"{self.name}{mark} {shown:.4g} {self.unit.removeprefix('1')}".rstrip()


def shown_as(study: Study, name: str) -> ShownAs:
    """Return how the figures of a study show a parameter.

    Where all cases have one natural frequency, ω_n = √(k/m), a frequency in Hz is shown as ω/ω_n as well, so that all
    figures can be compared and hold for other rigs; the label states ω_n/2π.
    """
    of = parameter(name)
    factor, unit = (100.0, "%") if name == "noise" else _SHOWN_IN.get(of.unit, (1.0, of.unit))
    m, k = (study.fixed.get(key) for key in ("m_kg", "k_N_per_m"))
    if name in (_RATIO, _HERTZ) and m is not None and k is not None:
        natural, ratio = math.sqrt(float(k) / float(m)) / (2.0 * math.pi), parameter(_RATIO).name
        label = rf"{ratio}, with $\omega_n/2\pi$ = {natural:.4g} Hz"
        return ShownAs(1.0 / natural if name == _HERTZ else 1.0, ratio, label, "1", natural)
    shown = of.meaning if name == "noise" else of.name
    return ShownAs(factor, shown, label_with_unit(shown, unit), unit)
