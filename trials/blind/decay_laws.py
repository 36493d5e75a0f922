"""Free decays that depart from friction and viscous damping: what `identify` says of them by default, and which law it
finds; and on contacts that yield gradually, and not at once.

A set is one of `decays.py` with a further term, which would take 10 to 40 % of the loss of the motion without it; of a
spring, 3 to 12 % of the force at the start. Friction that falls with speed is 10 to 40 % higher at rest, and falls over
3 to 30 % of the largest speed. "none" are the sets as they are, for false alarms.
"""

from __future__ import annotations

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
from .score import SYMBOLS, in_errors
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
    row["seconds_laws"] = time.process_time() - began if compared else 0.0
    answer = result.approaches[REFERENCE]
    said = [one.numbers for one in result.findings if one.code == "weighs"]
    shown = {of["what"][0].code: of["clear"] for of in said}
    row |= {
        "shown": any(shown.values()),
        "named": _NAMES.get(term, term) in shown,
        "gradual": "gradual" in shown,
        "chosen": ", ".join((laws and laws.chosen) or ()),
    }
    for symbol in SYMBOLS:
        p, true = answer.parameters[symbol], getattr(decay, symbol)
        row[f"{symbol}_off"] = p.value / true - 1.0
        row[f"{symbol}_sizes"] = abs(in_errors(symbol, p.value, true, p.standard_error))
        row[f"{symbol}_outside"] = not p.interval.low <= true <= p.interval.high
        row[f"{symbol}_usable"] = answer.verdicts[symbol].verdict == USABLE
    return [row]


def table(rows: pd.DataFrame) -> str:
    """Return a table by further term or contact, in sets: what was said, which numbers are usable, how many of these
    are silently wrong, and which law was chosen.

    Silent: usable and more than 5 standard errors off, or more than 3 % and outside its interval.
    """
    lines = []
    for term, some in rows.groupby("term", sort=False):
        known = some[some["F_k_usable"].notna()]
        cells = [len(some), len(some) - len(known)]
        cells += [known[name].astype(bool).sum() for name in ("shown", "named", "gradual")]
        for symbol in SYMBOLS:
            off, sizes, outside, usable = (
                known[f"{symbol}_{name}"].astype(float)
                for name in ("off", "sizes", "outside", "usable")
            )
            wrong = (sizes > _FAR) | ((off.abs() > _PART) & (outside > 0.0))
            cells += [int(usable.sum()), ((usable > 0.0) & wrong).sum()]
        law = known["chosen"][known["seconds_laws"] > 0.0]
        right = ", ".join(["F_k", "c", *([str(term)] if term == "c_2" else [])])
        counts = [(law == right).sum(), ((law != "") & (law != right)).sum(), (law == "").sum()]
        cells += counts if term in ("none", "c_2") and law.size else [""] * 3
        lines.append([str(term), *map(str, cells)])
    heads = ["further term or contact", "sets", "refused", "a departure shown", "its own named"]
    heads += ["gradual contact named"]
    for symbol in SYMBOLS:
        heads += [f"{symbol} usable", "of it silently wrong"]
    heads += ["law chosen: the true one", "another one", "none"]
    times = (rows[name] for name in ("seconds", "seconds_laws"))
    of_both = (f"{of.median():.1f} s (median), {of.max():.1f} s at the most" for of in times)
    return "{}\n\nProcessor time of an identification: {}; of the comparison of laws: {}.\n".format(
        markdown_table(heads, lines), *of_both
    )
