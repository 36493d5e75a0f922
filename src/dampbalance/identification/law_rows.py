"""Rows of the energy balance of a damping law, as one approach makes them from features."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ..balance import Approach, Rows
from ..features import Features, Phase
from ..law.law import Law
from ..law.terms import FRICTION


@dataclass(frozen=True, eq=False)
class LawRows:
    """How one approach makes rows of the balance of a law.

    k : N/m.   phase : that the harmonic approaches take.   linear : whether the records are those of a linear
    oscillator, so that friction has no column.
    """

    approach: Approach
    law: Law
    k: float
    phase: Phase
    linear: bool

    def __call__(self, features: Features) -> Rows:
        """The rows of features, with a column for each coefficient; one whose records all lack rows has none."""
        rows = self.approach(features.with_phase(self.phase), self.k, self.law.terms)
        if self.linear:
            rows = replace(rows, terms={**rows.terms, FRICTION: np.zeros(rows.W.shape)})
        rows = rows.of_law(self.law)
        kept = rows.usable
        empty = [key for key, g in rows.terms.items() if not np.where(kept, g, 0.0).any()]
        return replace(rows, given={**rows.given, **dict.fromkeys(empty, 0.0)})
