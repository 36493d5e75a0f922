"""The sampling rate and the channels as the lines above the rows of a text state them.

Such lines are `Sample rate: 2000 Hz`, `dt = 0,5 ms` and `Channel 1: Table, sensitivity 100.4 mV/g`.
"""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from ..errors import HIGHEST_RATE, LOWEST_RATE
from ..headings import key_of
from ..quantities import readings
from ..table import RATE_NAMES, STEP_NAMES, RawChannel
from ..units import VOLTS, find_motion, find_other, find_unit, split_label

# (?>…) and *+ do not backtrack, so that the time of a search grows at most with the square of the length of a line
_NUMBER = r"(?>\d{1,3}(?: \d{3})+(?=\s*[^\W\d])|\d[\d.,'\u00a0\u202f]*(?:e[+-]?\d+)?|[.,]\d+(?:e[+-]?\d+)?)"
_STEPS = (*STEP_NAMES, "interval")
_NAMES = "|".join(sorted((*RATE_NAMES, *_STEPS), key=len, reverse=True)).replace("_", r"[\s_'’-]*")
_TIMING = re.compile(
    # "Calibration interval" is no sampling interval; "recorded at fs = …" states the rate
    rf"(?:^|[^\w\s]|\bat\b|\bmit\b)\s*({_NAMES})\s*(?:[\[(]([^\])]*)[\])])?"
    rf"[\s:=,;|\"']*({_NUMBER})[\s,;|\"']*([^\W\d_]+(?:\s*(?:/|\bper\b|\bpro\b)\s*[^\W\d_]+)?)?",
    re.IGNORECASE,
)
_NUMBERED = (
    r"(?:ch|chan|channel|kanal|canal|voie|ai|input|eingang|sensor|通道|チャンネル)[\s.#_]*(\d+)"
)
_LINE = re.compile(r"\W*+([^:=,;|\t]+?)\s*([:=,;|\t])\s*(\S.*)")
_HEADING = re.compile(rf"(?:{_NUMBERED}|(\d+))(?:\s*\(([^)]*)\))?", re.IGNORECASE)
_SENSITIVITY = re.compile(
    rf"({_NUMBER})\s*([^\s,;|/]+(?:/s[²2^]*)?)\s*/\s*(\([^)]*\)|[^\s,;|)]+)", re.IGNORECASE
)
# signs that the samples are stored at another rate, and that the volts have a gain, or dB
_REDUCED = re.compile(
    r"(?:decimat|resampl|down-?sampl|dezimier|unterabtast)\w*+(?!\W*(?:1|no|none|off|nein|aus)\b)",
    re.IGNORECASE,
)
_GAIN = re.compile(
    r"(?:\bgain|amplification|verstärkung).{0,20}?(?<![^\W_])(\d+(?:[.,]\d+)?)", re.IGNORECASE
)
_DECIBELS = re.compile(r"(\d+(?:[.,]\d+)?)\s*dB\b")


def stated_rate(lines: Sequence[str], decimal: str, delimiter: str) -> dict[str, Any]:
    """Return what the header states about the clock, as fields of a channel: samples per second and the line that
    states them, or a fault if lines contradict each other."""
    rates = [
        (rate, " ".join(line.strip('#%;," \t\r\n').split()))
        for line in lines
        for match in _TIMING.finditer(line)
        if (rate := _rate(match, decimal, delimiter))
    ]
    # a step with few digits, 0.00049 s for 2048 Hz, is no contradiction
    if any(abs(rate / rates[0][0] - 1.0) > 0.01 for rate, _ in rates):
        said = " or ".join(f"{rate:g} ({line!r})" for rate, line in rates)
        return {"fault": f"{said} samples a second? Say sample_rate_hz in a mapping"}
    if rates and any(map(_REDUCED.search, lines)):
        said = f"{rates[0][0]:g} ({rates[0][1]!r}) before or after decimation"
        return {"fault": f"{said}? Say sample_rate_hz in a mapping"}
    return dict(zip(("rate_hz", "rate_line"), rates[0], strict=True)) if rates else {}


def _rate(match: re.Match[str], decimal: str, delimiter: str) -> float | None:
    """Return the samples per second that a line states; None if it is unclear, or has no unit of a rate or a step."""
    key, own, number, unit = match.groups()
    if delimiter == ",":  # it separates cells, or thousands
        number, _, rest = number.partition(",")
        if len(number) < 4 and re.match(r"\d{3}(?!\d)", rest):
            return None
    spelled = [text for text in (unit, unit and unit.split()[0], own) if text]
    known = next(filter(None, map(find_unit, spelled)), None)
    kind = "time" if re.sub(r"[\s_'’-]+", "_", key.lower()) in _STEPS else "frequency"
    kind = known.dimension if known else "" if spelled or key == "FS" else kind  # or full scale
    unit_in_si = known.factor if known else 1.0
    values = [of * unit_in_si for of in readings(number.rstrip(".,'"), decimal)]
    rates = {"time": [1.0 / of for of in values if of], "frequency": values}.get(kind, [])
    # below 20 Hz, a number without a unit may be an interval in ms, or a count
    least = LOWEST_RATE if known and len(values) == 1 else 20.0
    rates = [rate for rate in rates if least <= rate <= HIGHEST_RATE]
    return float(f"{rates[0]:.12g}") if len(rates) == 1 else None  # kHz and ms are rounded


def _sensor(text: str, decimal: str) -> RawChannel:
    """Return the channel that a text describes, "Table, 100.4 mV/g", "0.5 mm/V" or "Mass displacement (mm)": name, unit
    and, as its scale, units per volt; NaN if none are stated."""
    line = " ".join(text.split())
    for found in _SENSITIVITY.finditer(line):
        number, unit, per = found.groups()
        inverse, values = unit in VOLTS, readings(number, decimal)
        volts, of = (unit, per.strip("()")) if inverse else (per, unit)
        if len(values) == 1 and values[0] and volts in VOLTS and (known := find_motion(of)):
            size = 1.0 / values[0] if inverse else values[0]
            name = re.split("[,;|]", line[: found.start()])[0].rstrip(" ([=:-")
            return RawChannel(name, known.name, scale=size / VOLTS[volts], described=line)
    name, own = split_label(re.split("[,;|]", line)[0])
    unit = own if own and (find_unit(own) or find_other(own)) else None
    return RawChannel(name, unit, scale=math.nan, described=line)


def described(
    columns: Sequence[RawChannel], lines: Sequence[str], cells: Sequence[str], decimal: str
) -> list[RawChannel]:
    """Return the columns as a header describes them: name, unit, and the scale of volts; NaN if it is unclear whether a
    column is in volts. Lines belong to columns by the number in the heading, CH1, by its name, or by their order.

    cells : of a line of sensitivities, for the last columns.
    """
    sensors = dict[str, RawChannel]()
    for head, mark, text in (of.groups() for of in map(_LINE.match, lines) if of):
        of, numbered = _sensor(text, decimal), _HEADING.fullmatch(head)
        # "Mass: 2.4 kg" is no channel, and between commas alone it may be a line of names
        if (numbered and mark in ":=") or of.scale > 0.0:
            given = numbered and numbered[3]  # Channel 1 (Table): 100.4 mV/g
            sensors[_key(head)] = (
                replace(of, name=given, described=f"{given}, {text}") if given else of
            )
    own = {i: sensors.get(_key(split_label(raw.label)[0])) for i, raw in enumerate(columns)}
    others = len(columns) - len(sensors)
    if others in (0, 1) and not any(raw.label for raw in columns):
        own = {others + n: of for n, of in enumerate(sensors.values())}
    for i, cell in zip(reversed(range(len(columns))), reversed(cells), strict=False):
        own[i] = own.get(i) or replace(_sensor(cell, decimal), name="")
    made, amplified = [*columns], any(_has_gain(_GAIN, line) for line in lines)
    for i, sensor in own.items():
        if sensor is None or not (sensor.name or sensor.scale > 0.0):
            continue
        raw, text, unit, scale = columns[i], sensor.described, columns[i].unit, 1.0
        if sensor.scale > 0.0 and raw.unit in (None, *VOLTS):
            unit, scale = sensor.unit, sensor.scale * VOLTS.get(raw.unit or "", math.nan)
            text += f": 1 if recorded in {unit}, {sensor.scale:.6g} if in V" * math.isnan(scale)
            if scale > 0.0 and (amplified or _has_gain(_DECIBELS, text)):
                text, scale = f"{text}: {scale:.6g} without a gain", math.nan
        name, unit = sensor.name or raw.name, unit or sensor.unit
        made[i] = replace(raw, name=name, unit=unit, scale=scale, described=text)
    return made


def _has_gain(pattern: re.Pattern[str], line: str) -> bool:
    """Return whether a line states a gain other than 1 or 0 dB."""
    return any(float(of[1].replace(",", ".")) not in (0.0, 1.0) for of in pattern.finditer(line))


def _key(heading: str) -> str:
    """Return the key that a heading shares with a line about it: the number of a channel, or its name."""
    number = _HEADING.fullmatch(heading)
    return next(filter(None, number.groups())) if number else key_of(heading)


def keyed(table: Sequence[list[str]]) -> dict[str, list[str]]:
    """Return the lines of a header by `key_of` their first cells, without units."""
    return {key_of(split_label(cells[0])[0]): cells for cells in table if len(cells) > 1}
