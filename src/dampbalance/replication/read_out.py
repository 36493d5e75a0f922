"""Rules by which features were read off by eye: rounded, counted in marks of an axis, cut off by a display."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Self

import numpy as np

from ..arrays import Array
from ..features import Features

# Division by the unit leaves a rounding error: a quotient this close to a whole number counts as whole.
_WHOLE = 1e-9


@dataclass(frozen=True, slots=True)
class ReadOut:
    """Rules by which features are read; a rule that is None is not applied. SI units.

    X_decimals, X_s_decimals, V_s_decimals, phi_decimals : decimals kept in m, m, m/s, rad, rounded to nearest.
    X_n_decimals : decimals kept of the amplitudes X_1, X_3, X_5 of the harmonics, m.
    X_s_mark : m. Instead of rounding X_s: the length X + X_s of the microstick line in whole marks of the axis, up to
    the first mark beyond the corner, taken off the X that was read. (With marks of 1 µm, 12.3 µm read 13 µm.)
    t_s_inset : s, taken off t_s: timed from the first sample inside the microstick phase to the last one inside it, the
    phase is shorter than from reversal to slip, by one step at each end.
    t_s_unit : s. t_s is cut off to whole units, as on a display that drops digits (with 0.1 ms, 2.98 reads 2.9).
    common_phi_decimals, common_t_s_decimals : decimals of the means that stand for φ (rad), t_s (s) in Eqs. (16)–(19).

    The reverse-slip readings X_r, V_r, t_r follow the rules of X_s, V_s, t_s. Raises ValueError naming the rule.
    """

    X_decimals: int | None = None
    X_n_decimals: int | None = None
    X_s_decimals: int | None = None
    X_s_mark: float | None = None
    V_s_decimals: int | None = None
    phi_decimals: int | None = None
    t_s_inset: float = 0.0
    t_s_unit: float | None = None
    common_phi_decimals: int | None = None
    common_t_s_decimals: int | None = None

    def __post_init__(self) -> None:
        for name in self.__slots__:
            value = getattr(self, name)
            if value is not None and not 0 <= value < math.inf:
                raise ValueError(f"ReadOut.{name} must not be negative, got {value!r}")
        for name in ("X_s_mark", "t_s_unit"):
            if getattr(self, name) == 0.0:
                raise ValueError(f"ReadOut.{name} must be positive, or None for no such rule")
        if self.X_s_mark is not None and self.X_s_decimals is not None:
            raise ValueError("ReadOut: give X_s_mark or X_s_decimals, not both")

    @classmethod
    def from_config(cls, section: Mapping[str, Any]) -> Self:
        """Return the rules of a section of the configuration, whose keys carry their units; null is no rule."""
        rules = {key: value for key, value in section.items() if value is not None}
        return cls(**{key.removesuffix("_m").removesuffix("_s"): v for key, v in rules.items()})

    def apply(self, features: Features) -> Features:
        """Return the features as read, each response by itself."""
        X = _rounded(features.X, self.X_decimals)
        phases = ("phi", "phi_reversal", "phi_zero_crossing", "phi_fundamental")
        amplitudes = ("X_1", "X_3", "X_5")

        def slip(at: Array) -> Array:
            """Return |X_s| as read: by its mark, counted from the peak, or rounded."""
            if self.X_s_mark is None:
                return _rounded(at, self.X_s_decimals)
            return X - np.ceil((features.X - at) / self.X_s_mark - _WHOLE) * self.X_s_mark

        def time(t: Array) -> Array:
            inside, unit = t - self.t_s_inset, self.t_s_unit
            return inside if unit is None else np.floor(inside / unit + _WHOLE) * unit

        return features.replaced(
            X=X,
            X_s=-slip(-features.X_s),
            X_r=slip(features.X_r),
            V_s=_rounded(features.V_s, self.V_s_decimals),
            V_r=_rounded(features.V_r, self.V_s_decimals),
            t_s=time(features.t_s),
            t_r=time(features.t_r),
            **{name: _rounded(getattr(features, name), self.phi_decimals) for name in phases},
            **{name: _rounded(getattr(features, name), self.X_n_decimals) for name in amplitudes},
        )

    def common(self, features: Features) -> Features:
        """Return the features as read, with the rounded means of φ and t_s in place of the individual ones."""
        shared = self.apply(features).with_common("phi", "t_s")
        return shared.replaced(
            phi=_rounded(shared.phi, self.common_phi_decimals),
            t_s=_rounded(shared.t_s, self.common_t_s_decimals),
        )


def _rounded(values: Array, decimals: int | None) -> Array:
    return values if decimals is None else np.round(values, decimals)
