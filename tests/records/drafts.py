"""Drafts of mappings, as messages show them, with their blanks filled in."""

from __future__ import annotations

import yaml

UNITS = {"displacement": "mm", "velocity": "mm/s", "acceleration": "m/s²", "force": "N"}


def shown(message):
    """The mapping that a message shows, or that is suggested."""
    return yaml.safe_load(str(message).rpartition(", for example\n")[2])


def filled(draft, chosen=(), scale=1.0, units=UNITS, **more):
    """A draft with its blanks filled in: what columns hold, quantity → name or number; a column that is not chosen is
    left out; units that the file lacks; more keys."""
    section = "table" if "table" in draft else "channels"
    columns = {}
    for key, rule in draft[section].items():
        if key.endswith("?"):
            alike = (
                q
                for q, of in dict(chosen).items()
                if rule["channel"] in (of if isinstance(of, tuple) else (of,))
            )
            key = next(alike, None)
        if key is not None:
            given = {
                "unit": units.get(key.removeprefix("base_").removeprefix("relative_")),
                "scale": scale,
            }
            columns[key] = {k: given[k] if v == "?" else v for k, v in rule.items()}
    rest = {k: v for k, v in draft.items() if v != "?"}
    if rest.get("time", {}).get("unit") == "?":
        rest["time"] = rest["time"] | {"unit": "s"}
    return rest | {section: columns} | more
