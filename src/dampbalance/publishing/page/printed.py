"""What the instruments of the page need that work on the paper's printed numbers."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import pandas as pd

from ...figures.looks import SCHEME_LOOKS
from ...motion.fixed_step import SCHEMES
from ...project.wording import plain
from ...replication.as_published import coefficients
from ...replication.claim_verdicts import VERDICTS
from ...replication.printed_tables import TABLE_2, UNKNOWNS
from .content import PageContent

STOPS_US = (1, 1.5, 2, 2.5, 3, 4, 4.5, 5, 5.5, 6, 7, 8, 10, 15, 20, 30, 50)
"""Steps that "Guess the integrator" offers, µs; the configured one is among them in any case."""


def printed_data(content: PageContent) -> dict[str, Any]:
    """The data of `integrator.js` and `digits.js`; empty for a case with nothing printed.

    integrator : the schemes, the recipe of the configuration, Table 2 as printed (the text), its pairs of levels.
    digits, where there are any : `changed_digits.packed` with names for the numbers and the looks of the verdicts.
    """
    if content.claims is None:
        return {}
    case, rows = content.case, {row["id"]: row for row in content.claims.to_dict("records")}
    numerics = case.numerics
    printed = {
        q.symbol: {
            claim.rpartition(".")[2]: row["printed"]
            for claim, row in rows.items()
            if claim.startswith(f"table2.{q.symbol}.")
        }
        for q in (*TABLE_2, *UNKNOWNS)
    }
    step = float(f"{1e6 * numerics.step_s:.12g}")
    digits = content.digits and {
        **content.digits,
        "looks": [(verdict.css, verdict.mark) for verdict in VERDICTS.values()],
        "names": {
            name: _name(rows[name]["where"], rows[name]["quantity"])
            for name in content.digits["was"]
        },
    }
    return {
        "integrator": {
            "schemes": [
                {"name": name, "label": SCHEME_LOOKS[name][0], "dissipation": scheme.dissipation}
                for name, scheme in SCHEMES.items()
            ],
            "recipe": {
                "scheme": numerics.scheme,
                "step": step,
                "cycles": numerics.cycles,
                "slip_samples": [numerics.after_slip(i) for i in range(len(case.levels_m))],
                "decimals": [numerics.c_over_m_decimals, numerics.k_over_m_decimals],
            },
            "rounded": coefficients(case),
            "stops": sorted({*STOPS_US, step}),
            "omega": case.omega(next(iter(case.frequencies_hz))),
            "printed": {symbol: list(of.values()) for symbol, of in printed.items()},
            "pairs": [[int(level) - 1 for level in label.split("-")] for label in printed["F_k"]],
        },
        **({"digits": digits} if digits else {}),
    }


def of_run(record: Mapping[str, Any], claims: pd.DataFrame) -> bool:
    """Whether a record by `changed_digits.packed` is of a run's print and verdicts.   claims : claims.csv as text."""
    computed = claims[claims["kind"] == "computed"].set_index("id")
    was = {name: record["verdicts"][place] for name, place in record["was"].items()}
    printed = {name: text for name, (text, _) in record["numbers"].items()}
    same = printed.items() <= computed["printed"].to_dict().items()
    return same and was == computed["verdict"].to_dict()


def _name(where: str, quantity: str) -> str:
    """A printed number in a few words: "level 2: X_s", "pair 1-2: F_k by X_s"; of the running text what it is."""
    table, _, line = where.partition(", ")
    if not table.startswith("Table"):
        return plain(quantity)
    return plain(f"{line}: {quantity.partition(':')[0].partition(', ')[0]}")
