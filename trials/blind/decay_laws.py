"""Free decays that depart from friction and viscous damping: what `identify` says of them by default, and which law it
finds; and on contacts that yield gradually, and not at once.

A set is one of `decays.py` with a further term, which would take 10 to 40 % of the loss of the motion without it; of a
spring, 3 to 12 % of the force at the start. Friction that falls with speed is 10 to 40 % higher at rest, and falls over
3 to 30 % of the largest speed. "none" are the sets as they are, for false alarms.
"""

from __future__ import annotations

import math
import time
from dataclasses import replace

import numpy as np
import pandas as pd

from dampbalance.identification.answer import REFERENCE, USABLE
from dampbalance.identification.decays import identify_decay_records
from dampbalance.identification.law_comparison import compare_decay_laws
from dampbalance.project.wording import markdown_table

from . import gradual
from .decays import departing, draw, falling, record
from .truths import log_uniform

TERMS = {
    "none": ("", 0),
    "c_2": ("quadratic", 2),
    "k_3": ("cubic", 3),
    "Stribeck": ("falling", 0),
}
"""Field of `Departure` and power of each further term."""

CONTACTS = tuple(gradual.CONTACTS)
"""Contacts that yield gradually: F_k, c and K_z are right if the right contact is asked for."""

ALL = (*TERMS, *CONTACTS)

_SHARES, _SPRING = (0.1, 0.4), 0.3  # of the loss; of that share, of the force of a spring
_FALLS = (0.03, 0.3)  # of the largest speed, over which friction falls
_SHARE = 3  # so that the share is not drawn from the generator that drew the set
_FAR = 5.0  # standard errors
_PART = 0.03  # of a value
_NAMES = {"Stribeck": "falling", **dict.fromkeys(CONTACTS, "gradual")}  # of departures


def outcome(run: tuple[str, int, int, bool]) -> list[dict[str, object]]:
    """Return a row for a set: what was said, how far off its values are, which law was chosen.   run : term, number,
    seed, and whether the laws are compared, which takes most of the time."""
    term, index, seed, compared = run
    decay = draw(index, seed)
    random = np.random.default_rng((_SHARE, seed, index))
    share = float(random.uniform(*_SHARES))
    field, order = TERMS.get(term, ("", 0))
    if term in CONTACTS:
        decay = replace(decay, contact=term)
    if field == "falling":
        decay = falling(decay, share, log_uniform(random)(*_FALLS))
    elif field:
        decay = departing(decay, field, order, share * (_SPRING if term.startswith("k") else 1.0))
    row: dict[str, object] = {"term": term, "set": index, "share": share, "noise": decay.noise}
    row |= {"zeta": decay.zeta, "height": decay.height}
    measured, _ = record(decay, seed)
    began = time.process_time()
    try:
        result = identify_decay_records([measured], decay.k)
    except ValueError as error:
        return [row | {"refused": str(error)}]
    row["seconds"] = time.process_time() - began
    began = time.process_time()
    laws = compare_decay_laws(result.basis.fit) if compared else None
    row["seconds_laws"] = time.process_time() - began
    answer = result.approaches[REFERENCE]
    said = [one.numbers for one in result.findings if one.code == "weighs"]
    shown = {of["what"][0].code: of["clear"] for of in said}
    row |= {
        "slips": result.basis.half_cycles.halves,
        "usable": all(answer.verdicts[s].verdict == USABLE for s in ("F_k", "c")),
        "shown": any(shown.values()),
        "named": _NAMES.get(term, term) in shown,
        "gradual": "gradual" in shown,
        "chosen": ", ".join((laws and laws.chosen) or ()),
        "alike": "; ".join(", ".join(terms) for terms in laws.alike) if laws else "",
    }
    for symbol in ("F_k", "c", "K_z"):
        p, true = answer.parameters[symbol], getattr(decay, symbol)
        row[f"{symbol}_off"] = p.value / true - 1.0
        row[f"{symbol}_sizes"] = abs(p.value - true) / p.standard_error
        if symbol == "K_z":  # nearly normal as K_z^{−1/2}
            row["K_z_sizes"] *= 2.0 * (p.value / true) / (1.0 + math.sqrt(p.value / true))
        row[f"{symbol}_outside"] = not p.interval.low <= true <= p.interval.high
        row[f"{symbol}_usable"] = answer.verdicts[symbol].verdict == USABLE
    true_law = ("F_k", "c", *((term,) if term == "c_2" else ()))
    weighed = laws.laws if laws else ()
    row["weight_of_true"] = next((one.weight for one in weighed if one.terms == true_law), math.nan)
    return [row]


def table(rows: pd.DataFrame) -> str:
    """Return a table by term, in sets: what was said, how many are silently wrong, and which law was chosen."""
    lines = []
    for term, some in rows.groupby("term", sort=False):
        known = some[some["usable"].notna()]
        flags = {c: known[c].astype(bool) for c in ("shown", "named")}
        wrong = pd.Series(False, index=known.index)
        for symbol in ("F_k", "c"):
            wrong |= (known[f"{symbol}_sizes"] > _FAR) & known[f"{symbol}_usable"].astype(bool)
        right = ", ".join(["F_k", "c", *([str(term)] if term == "c_2" else [])])
        chosen = known["chosen"] == right
        cells = [len(some), len(some) - len(known), flags["shown"].sum(), flags["named"].sum()]
        cells += [(~known["usable"].astype(bool)).sum()]
        K_z = (known["K_z_sizes"] > _FAR) & known["K_z_usable"].astype(bool)
        cells += [wrong.sum(), known["gradual"].astype(bool).sum()]
        cells += [known["K_z_usable"].sum(), K_z.sum()]
        fewer = (known["chosen"] != "") & ~chosen
        counts = [chosen.sum(), fewer.sum(), (known["chosen"] == "").sum()]
        cells += counts if term in ("none", "c_2") else ["", "", ""]
        lines.append([str(term), *map(str, cells)])
    heads = [
        "further term",
        "sets",
        "refused",
        "a departure shown",
        "its own named",
        "F_k or c doubtful for any reason",
    ]
    heads += [f"usable and more than {_FAR:g} standard errors off"]
    heads += ["gradual contact named", "K_z usable", "of it far off"]
    heads += ["law chosen: the true one", "another one", "none"]
    return (
        f"{markdown_table(heads, lines)}\n\nProcessor time of the comparison of laws: "
        f"{rows['seconds_laws'].median():.1f} s (median), {rows['seconds_laws'].max():.1f} s at the most; of the rest "
        f"{rows['seconds'].median():.1f} s and {rows['seconds'].max():.1f} s.\n"
    )


def table_of_contacts(rows: pd.DataFrame) -> str:
    """Return a table by contact, in sets: which numbers are usable, which of these are wrong."""
    lines = []
    for contact, some in rows.groupby("term", sort=False):
        known = some[some["usable"].notna()]
        usable = {s: known[f"{s}_usable"].astype(bool) for s in ("F_k", "K_z")}
        cells = [len(some), len(some) - len(known), known["gradual"].astype(bool).sum()]
        cells += [known["shown"].astype(bool).sum(), *(of.sum() for of in usable.values())]
        for symbol, of in usable.items():
            off = known[f"{symbol}_off"].abs() > _PART
            far = (of & (known[f"{symbol}_sizes"] > _FAR), of & off & known[f"{symbol}_outside"])
            cells += [wrong.sum() for wrong in far]
            cells += [(far[0] | far[1]).sum()]
        lines.append([str(contact), *map(str, cells)])
    heads = ["contact", "sets", "refused", "gradual contact named", "a departure shown"]
    heads += ["F_k usable", "K_z usable"]
    for symbol in ("F_k", "K_z"):
        heads += [f"{symbol} usable and more than {_FAR:g} standard errors off"]
        heads += [f"and more than {100.0 * _PART:g} % off, outside its interval", "silent"]
    seconds = rows["seconds"]
    return (
        f"{markdown_table(heads, lines)}\n\nProcessor time of an identification: {seconds.median():.1f} s (median), "
        f"{seconds.max():.1f} s at the most.\n"
    )
