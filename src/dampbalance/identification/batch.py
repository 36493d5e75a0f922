"""Several sets of records, identified one by one: their estimates in one table and on one page, with every failure."""

from __future__ import annotations

import difflib
import glob
import hashlib
import json
import math
import os
from collections.abc import Iterator, Mapping
from datetime import date
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any
from urllib.parse import quote

import pandas as pd

from .. import __version__
from ..project.files import read_csv, sha256, write_csv, write_text
from ..project.troubles import trouble
from ..project.wording import listed, number, shortened, with_unit
from ..records.errors import library
from ..records.mapping import mapping_file, mapping_for, parts_of
from .answer import DOUBTFUL, USABLE, Interval, ParameterEstimate, Verdict, column, unit_of
from .measured import SETTINGS, configured, identify
from .outputs import COMPLETE, ESTIMATES, REPORT, SUMMARY, TABLES, outputs_of, require_room
from .screen import aligned, headed, in_one, with_interval

_VERDICT = "_verdict"


def read_sets(file: str | Path) -> list[dict[str, Any]]:
    """The sets of records that a YAML file lists under `measured`, as a configuration of the workflow does.

    Raises ValueError naming file, set, key and remedy.
    """
    library("yaml", "a list of sets")
    library("jsonschema", "a list of sets")
    from ..project.documents import read_yaml

    document = read_yaml(file)
    sets = document.get("measured") if isinstance(document, Mapping) else None
    example = "measured: [{name: steady, records: [level*.csv], stiffness_N_per_m: 2310}]"
    if not isinstance(sets, list) or not sets:
        raise ValueError(f"{file}: lists no sets of records; give at least one, as in {example}")
    for i, one in enumerate(sets):
        if not isinstance(one, Mapping):
            raise ValueError(f"{file}: measured[{i}] is no set; give keys, as in {example}")
        name = one.get("name")
        if not isinstance(name, str) or Path(name).name != name or name.startswith("."):
            raise ValueError(f"{file}: measured[{i}].name names a folder; got {shortened(name)}")
        for key in one:
            if key not in SETTINGS:
                near = difflib.get_close_matches(str(key), SETTINGS, n=1)
                raise ValueError(
                    f"{file}: {key} of the set {name} is not known"
                    + (f" (did you mean {near[0]}?)" if near else f"; known: {', '.join(SETTINGS)}")
                )
        needed = ["stiffness_N_per_m"] * (one.get("kind") != "stepped-sine")
        for key in ("records", *needed):
            if one.get(key) in (None, []):
                raise ValueError(f"{file}: the set {name} has no {key}; add it")
    names = [one["name"].casefold() for one in sets]
    if len(set(names)) < len(names):
        raise ValueError(f"{file}: two sets have the same name, capital or small; rename one")
    return [dict(one) for one in sets]


def identify_sets(
    file: str | Path, folder: str | Path, *, overwrite: bool = False
) -> tuple[str, int]:
    """Identify all sets of a file, each into a folder of its name; return the table of all, and how many failed.

    A set that cannot be identified keeps no other from it, and stands with its error in table and page. One whose
    records and settings are those of its results is not identified again.

    file : as for `read_sets`; records and mappings are looked for from the present folder on, then from that of the
    file.   folder : for the results.   overwrite : whether results of other settings or records may be replaced.

    Raises ValueError for a file that lists no sets, and where nothing can be written.
    """
    sets, folder, root = read_sets(file), Path(folder), Path(file).parent
    require_room(folder, (), "")
    errors: dict[str, str] = {}
    for one in sets:
        try:
            _identify_set(one, root, folder / one["name"], overwrite)
            errors[one["name"]] = ""
        except (ValueError, ArithmeticError, OSError) as error:
            errors[one["name"]] = " ".join((trouble(error) or str(error)).split("\n"))
    text = summarise(folder, errors, {one["name"]: one.get("at") for one in sets})
    return text, sum(map(bool, errors.values()))


def _identify_set(one: Mapping[str, Any], root: Path, folder: Path, overwrite: bool) -> None:
    patterns = one["records"] if isinstance(one["records"], list) else [one["records"]]
    records = list(dict.fromkeys(f for pattern in patterns for f in _matching(pattern, root)))
    settings = configured(one)
    if mapping := settings.get("mapping"):
        settings["mapping"] = mapping if Path(mapping).exists() else str(root / mapping)
    mapping = settings.get("mapping")
    of_mapping = {mapping_file(record, mapping) for record in records} - {None}
    parts = {part for record in records for part in parts_of(record, mapping_for(record, mapping))}
    used = [*records, *sorted({str(path) for path in of_mapping | parts} - {*records})]
    made_of = [__version__, settings, [(path, sha256(path)) for path in used]]
    digest = hashlib.sha256(json.dumps(made_of, default=str).encode()).hexdigest()
    mark = folder / COMPLETE
    files = [folder / name for name in outputs_of(settings["kind"])]
    same = mark.is_file() and mark.read_text(encoding="utf-8").strip() == digest
    if same and all(path.is_file() for path in files):
        return
    require_room(folder, TABLES, "" if overwrite or same else "--overwrite")
    result = identify(records, **settings)
    mark.unlink(missing_ok=True)
    result.save(folder, overwrite=True)
    write_text(mark, digest + "\n")


def _matching(pattern: str, root: Path) -> list[str]:
    """The records that a pattern finds, sorted; ValueError for none."""
    if Path(pattern).is_file():  # whatever brackets its name has
        return [pattern]
    found = glob.glob(pattern) or [
        os.path.join(root, name) for name in glob.glob(pattern, root_dir=root)
    ]
    files = sorted(name for name in found if not name.endswith((".yaml", ".md")))
    if not files:
        where = "this folder" if root.samefile(".") else f"this folder or to {root}"
        raise ValueError(f"no file {pattern}: name files, or a pattern, relative to {where}")
    return files


def summarise(folder: Path, errors: Mapping[str, str], at: Mapping[str, Any] | None = None) -> str:
    """Write the estimates of all sets as one table, as text a line for each set, and a page; return the text.

    folder : with one of its name for each set that is identified.   errors : set → why it could not be identified,
    empty where it was.   at : set → date or load that it belongs to, by which sets are put in order and drawn.
    """
    stated = {name: (at or {}).get(name) for name in errors}
    places, dated = _places(stated)
    order = sorted(errors, key=places.__getitem__) if places else list(errors)
    failed = {name: errors[name] for name in order if errors[name]}
    parts = []
    for name in order:
        error = errors[name]
        one = pd.DataFrame({"error": [error]}) if error else read_csv(folder / name / ESTIMATES)
        one.insert(0, "set", name)
        if any(of is not None for of in stated.values()):
            one.insert(1, "at", "" if stated[name] is None else str(stated[name]))
        parts.append(one)
    every = pd.concat(parts, ignore_index=True)
    every["error"] = every.pop("error") if failed else ""
    symbols = [str(head).removesuffix(_VERDICT) for head in every if str(head).endswith(_VERDICT)]
    symbols.sort(key=lambda symbol: symbol == "K_z")  # the contact last
    shown = ["set", *["at"] * ("at" in every)]
    table = [[*shown, "answer", *map(headed, symbols), "verdict"]]
    estimates: dict[str, dict[str, tuple[ParameterEstimate, str]]] = {s: {} for s in symbols}
    doubtful = []
    for row in every.groupby("set", sort=False).head(1).to_dict("records"):
        name, verdicts, cells = row["set"], {}, []
        for symbol in symbols:
            p, word = _parameter(row, symbol), row[symbol + _VERDICT]
            if isinstance(word, str) and word:
                verdicts[symbol], estimates[symbol][name] = Verdict(word), (p, word)
            cells.append("–" if name in failed else with_interval(p))
        words = "not identified" if name in failed else in_one(verdicts)
        doubtful += [name] if name not in failed and words != USABLE else []
        approach = "–" if name in failed else row["approach"]
        table.append([*(str(row[head]) for head in shown), approach, *cells, words])
    head = f"{len(errors) - len(failed)} of {len(errors)} sets of records identified"
    lines = [f"{head} in {folder}; the answer to use of each:", "", *aligned(table)]
    lines += ["", *(f"{name}: {error}" for name, error in failed.items())] if failed else []
    text = "\n".join(lines) + "\n"
    write_csv(folder / ESTIMATES, every)
    write_text(folder / SUMMARY, text)
    from ..figures.style import save_svg  # slow to import, as are the pictures
    from .pictures import sets
    from .report import page_of

    with TemporaryDirectory() as own:
        svg = Path(own) / "sets.svg"
        if symbols:
            save_svg(sets(order, estimates, places, dated), svg)
        drawing = svg.read_text(encoding="utf-8") if symbols else ""
    lead = head + "".join(
        f"; {what}: {listed(names)}"
        for what, names in (("in part doubtful", doubtful), ("not identified", [*failed]))
        if names
    )
    page = page_of(
        "sets",
        lead=(f"{lead}.", f"lead {DOUBTFUL if failed or doubtful else USABLE}"),
        head=head,
        heads=table[0],
        rows=[(row, "" if row[0] in failed else f"{quote(row[0])}/{REPORT}") for row in table[1:]],
        failed=[f"the set {name}: {error}" for name, error in failed.items()],
        agreement=[*_agreement(estimates)],
        drawing=drawing,
    )
    write_text(folder / REPORT, page)
    return text


def _places(at: Mapping[str, Any]) -> tuple[dict[str, float], bool]:
    """Numbers, or days, that sets belong to, and whether they are days; none where one of them is neither."""

    def day(text: str) -> float:
        return float(date.fromisoformat(text).toordinal())

    for reading in (float, day):
        try:
            return {name: reading(str(of)) for name, of in at.items()}, reading is day
        except ValueError:
            continue
    return {}, False


def _agreement(
    estimates: Mapping[str, Mapping[str, tuple[ParameterEstimate, str]]],
) -> Iterator[str]:
    """For each number whether one value lies in the intervals of all sets."""
    for symbol, of_sets in estimates.items():
        ends = [p.interval for p, _ in of_sets.values() if math.isfinite(p.interval.low)]
        if len(ends) < 2:
            continue
        low, high = max(end.low for end in ends), min(end.high for end in ends)
        least, most = (with_unit(number(end, 4), unit_of(symbol)) for end in (low, high))
        if low <= high:
            upper = f"{number(low, 4)} to {most}" if math.isfinite(high) else "values"
            yield f"{symbol}: the intervals of all sets have {upper} in common"
        else:
            yield (
                f"{symbol}: the sets differ by more than their intervals show; no value from {number(high, 4)} to "
                f"{least} lies in all of them"
            )


def _parameter(row: Mapping[Any, Any], symbol: str) -> ParameterEstimate:
    """A number of a row of the table of estimates."""
    value, low, high = (
        float(row.get(column(symbol, end), math.nan)) for end in ("", "_low", "_high")
    )
    if math.isnan(high) and math.isfinite(low):  # an open end is empty in the table
        high = math.inf
    return ParameterEstimate(value, math.nan, math.nan, Interval(low, high))
