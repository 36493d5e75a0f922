"""The numbers of the recipe for the paper's Table 3: every step from the equation of motion to the printed digits."""

from __future__ import annotations

from typing import Any

from ...features import Features
from ...project.case import Case
from ...replication.readout import ReadOut
from .book import Book
from .style import Style


def evidence(case: Case, exact: Features) -> dict[str, Any]:
    """What the rules of reading make of the responses at the first frequency. None: the case has no such rule.

    periods : simulated before the cycle that is read.   slip_samples : after slip is seen, where a begins.
    X_um, mark_um : units to which X and X + X_s are read.   swing_um : X + X_s as read, at every level.
    steps : off t_s.   t_s_unit_ms, t_s_ms : unit of t_s, and the one that stands for all levels.
    phi, phi_decimals : the phase that stands for all levels, rad.

    exact : features of the exact responses; what is read to so coarse a unit is the same off the simulation.
    """
    from ...reading.clean import CYCLES_TO_READ  # slow to import, and of no use to `enter`

    numerics = case.numerics
    rules = ReadOut.from_config(numerics.two_point)
    common = rules.common(exact)
    swings = sorted({round(1e6 * swing, 6) for swing in (common.X + common.X_s).tolist()})
    return {
        "periods": numerics.cycles - CYCLES_TO_READ,
        "slip_samples": ", ".join(map(str, numerics.slip_samples)),
        "X_um": None if rules.X_decimals is None else 10.0 ** (6 - rules.X_decimals),
        "mark_um": None if rules.X_s_mark is None else 1e6 * rules.X_s_mark,
        "swing_um": swings[0] if rules.X_s_mark is not None and len(swings) == 1 else None,
        "steps": round(rules.t_s_inset / numerics.step_s, 3),
        "t_s_unit_ms": None if rules.t_s_unit is None else 1e3 * rules.t_s_unit,
        "t_s_ms": 1e3 * float(common.t_s[0]),
        "phi": float(common.phi[0]),
        "phi_decimals": rules.common_phi_decimals,
    }


def enter(book: Book, file: str) -> None:
    """Enter the values of the recipe.   file : the evidence."""
    plain, word = Style("plain"), Style("word")
    for name, style, unit in (
        ("periods", plain, ""),
        ("slip_samples", Style("text"), ""),
        ("X_um", plain, "µm"),
        ("mark_um", plain, "µm"),
        ("swing_um", plain, "µm"),
        ("steps", word, ""),
        ("t_s_unit_ms", plain, "ms"),
        ("t_s_ms", plain, "ms"),
        ("phi", plain, ""),
        ("phi_decimals", word, ""),
    ):
        book.item(f"recipe.{name}", file, f"/recipe/{name}", style, unit)
    book.cell(
        "recipe.from_table_1",
        "claims.csv",
        {"id": "table3.t_s.F_k.1-2"},
        "from_print",
        Style("fixed", 4),
        "N",
    )
