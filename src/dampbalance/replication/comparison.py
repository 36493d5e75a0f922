"""The errors of F_k and c by every approach, at every frequency, for each definition of the phase.

The paper compares its approaches at resonance, with one definition of the phase. This table adds what each approach
gives off resonance, where the harmonic ones fail for three reasons: they use the phase of the velocity reversal in
place of that of the fundamental, one phase for all levels (in the pairs; the paper's least squares takes each level's
own), and the peak X in place of the amplitude X_1. `cause_shifts` gives the effect of each, `mends` the remedies. The
features are exact, so that each error is that of the approach.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from itertools import product
from typing import TYPE_CHECKING

from ..balance import APPROACHES, TERMS, takes_phase
from ..project.wording import markdown_table, percent, signed, signed_percent
from .numbers import PHASES, Numbers, number

if TYPE_CHECKING:
    import pandas as pd

SHARINGS = ("individual", "common")
_ERRORS = {"least_squares": "error_percent", "largest": "largest_pair_error_percent"}

WAY = ("approach", "phase", "sharing")
WAYS_TO_COMPARE = {
    "mean": ("X_s", "reversal", "common"),
    "reversal": ("X_s", "reversal", "individual"),
    "shared": ("X_s", "fundamental", "common"),
    "crossing": ("X_s", "zero_crossing", "individual"),
    "fundamental": ("X_s", "fundamental", "individual"),
    "fourier": ("fourier", "", ""),
    "direct": ("direct", "", ""),
}
"""Ways to identify F_k and c, compared off resonance: name → columns WAY of the table.

The pairs of "mean" are the paper's, and the least squares of "reversal" is the paper's. The least squares of "mean"
combines the two, as the paper never does: it shows what the phase of the pairs costs with all levels.
"""
RECIPES = {
    "mean": "one phase of the reversal for all levels, as in the paper’s pairs",
    "reversal": "each level’s phase of the reversal, as in the paper’s least squares",
    "crossing": "each level’s phase of the zero crossing",
    "shared": "one phase of the fundamental for all levels",
    "fundamental": "each level’s phase of the fundamental",
    "fourier": "Fourier balance",
}
"""A way of WAYS_TO_COMPARE → in words: the paper's two, then each remedy."""

CAUSES = {"which": "reversal", "shared": "shared", "both": "mean"}
"""A wrong phase → the way of WAYS_TO_COMPARE that uses it: which phase, one phase for all levels, and both."""


def approaches_table(numbers: Numbers, frequencies_hz: Mapping[str, float]) -> pd.DataFrame:
    """Tabulate the errors of the coefficients, %, by every approach, definition of the phase, and frequency.

    Columns: frequency, frequency_hz; approach, a key of balance.APPROACHES; phase, reversal, zero_crossing or
    fundamental; sharing, φ and t_s individual to each level or common to all (both empty for an approach that takes no
    phase). Then F_k_error_percent … of the least squares over all levels, with sign, and
    F_k_largest_pair_error_percent …, the size of the largest over the pairs of levels.

    frequencies_hz : in the order of the table.

    NaN: an estimate that does not exist (nothing slips), and an error relative to a true value of zero.
    """
    ways = [
        dict(zip(WAY, way, strict=True))
        for name in APPROACHES
        for way in (product((name,), PHASES, SHARINGS) if takes_phase(name) else [(name, "", "")])
    ]
    records = [
        {"frequency": name, "frequency_hz": hz, **way}
        | {
            f"{symbol}_{column}": number(
                numbers, "exact", frequency=name, quantity=symbol, kind=kind, unit="%", **way
            )
            for kind, column in _ERRORS.items()
            for symbol in TERMS
        }
        for name, hz in frequencies_hz.items()
        for way in ways
    ]
    import pandas as pd  # slow to import, and needed for tables only

    return pd.DataFrame.from_records(records)


def approaches_markdown(table: pd.DataFrame, title: str) -> str:
    """Return the table for reading: a line per approach and phase, the frequencies side by side."""
    lines = [f"# {title}", ""]
    for heading, column in (
        ("Least squares over all levels", "{}_error_percent"),
        ("The pair of levels that is furthest off", "{}_largest_pair_error_percent"),
    ):
        lines += [f"## {heading}", "", _side_by_side(table, column), ""]
    lines += [
        "From exact features, so each error is that of the approach. Phase: the lag of x behind y of the velocity "
        "reversal, of the displacement's zero crossing, or of its fundamental; φ and t_s of each level, or their mean.",
        "",
    ]
    return "\n".join(lines)


def cause_shifts(
    approaches: pd.DataFrame, frequencies: Iterable[str]
) -> dict[str, dict[str, float]]:
    """Tabulate the effect of each cause of failure on F_k by X_s and least squares, in percentage points, by frequency.

    peak : the error, %, with each level's phase of the fundamental: X in place of X_1 is then the only fault.
    which : the shift from there by each level's phase of the reversal.   shared : by one phase of the fundamental for
    all levels.   both : by one phase of the reversal for all levels. The effects do not add up.

    approaches : the table of `approaches_table`.
    """
    errors = _of_F_k(approaches)
    shifts = {}
    for name in frequencies:
        peak = errors[*WAYS_TO_COMPARE["fundamental"], name]
        wrong = {cause: errors[*WAYS_TO_COMPARE[way], name] - peak for cause, way in CAUSES.items()}
        shifts[name] = {"peak": peak, **wrong}
    return shifts


def off_resonance(
    approaches: pd.DataFrame, frequencies_hz: Mapping[str, float]
) -> list[dict[str, str]]:
    """Return the `cause_shifts` in words, frequency by frequency.

    hz : the frequency.   peak : an error, %.   paper : that of the paper's least squares, which takes each level's
    phase of the reversal.   which, shared, both : shifts, percentage points.

    approaches : the table of `approaches_table`.
    """
    errors = _of_F_k(approaches)
    return [
        {
            "hz": f"{frequencies_hz[name]:g} Hz",
            "peak": signed_percent(0.01 * shifts["peak"]),
            "paper": signed_percent(0.01 * errors[*WAYS_TO_COMPARE["reversal"], name]),
            **{cause: signed(shifts[cause], 1) for cause in CAUSES},
        }
        for name, shifts in cause_shifts(approaches, frequencies_hz).items()
    ]


def mends(approaches: pd.DataFrame, frequencies_hz: Mapping[str, float]) -> dict[str, list[float]]:
    """Return the error of F_k, %, by least squares: every way of RECIPES in words → one for each frequency."""
    errors = _of_F_k(approaches)
    return {
        words: [errors[*WAYS_TO_COMPARE[way], name] for name in frequencies_hz]
        for way, words in RECIPES.items()
    }


def _of_F_k(approaches: pd.DataFrame) -> dict[tuple[str, ...], float]:
    """Return the error of F_k by least squares, %, by approach, phase, sharing and frequency."""
    keys = zip(*(approaches[name] for name in (*WAY, "frequency")), strict=True)
    return dict(zip(keys, approaches["F_k_error_percent"], strict=True))


def _side_by_side(table: pd.DataFrame, column: str) -> str:
    frequencies = dict(zip(table["frequency"], table["frequency_hz"], strict=True))
    heads = [f"{name}, {hz:g} Hz" for hz in frequencies.values() for name in TERMS]
    columns = [column.format(name) for name in TERMS]
    cells = []
    for key, rows in table.groupby(list(WAY), sort=False):
        errors = rows.set_index("frequency")[columns].reindex(list(frequencies)).to_numpy().ravel()
        words = (str(word).replace("_", " ") or "–" for word in key[1:])
        cells.append([str(key[0]), *words, *map(error_text, errors)])
    return markdown_table(["approach", "phase", "φ, t_s", *heads], cells, "lll" + "r" * len(heads))


def error_text(error: float, plus: str = "") -> str:
    """Return an error given in % as text, with its sign; a bound without a sign where it is nothing but rounding.

    plus : the sign of a positive one.
    """
    if abs(error) < 1e-6:
        return f"≤ {percent(0.01 * error)}"
    return signed_percent(0.01 * error, plus=plus)
