"""The report of an identification: one HTML file that needs nothing else, to be read, printed and handed on.

`report` writes it of one set of records, `identification.batch` of several sets; both are made of the pieces here.
"""

from __future__ import annotations

import base64
import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from html import escape
from importlib.resources import files
from pathlib import PurePath
from typing import Any

from .. import __version__
from ..figures.style import COOL, DARK, GRID, INK, PAPER, follows_the_screen
from ..law.terms import parted, term
from ..project.wording import (
    Remark,
    dotted,
    in_html,
    listed,
    number,
    percent,
    signed_percent,
    visible,
)
from .answer import DOUBTFUL, NONE, USABLE, Answer, ParameterEstimate, unit_of
from .outcome import Outcome
from .remarks import in_a_sentence, limits
from .screen import answers_table, comparison, interval_of, value_of

_COLOURS = {  # on paper, on a dark screen: contrast of text of at least 4.5 : 1
    "paper": (PAPER, DARK[PAPER]),
    "ink": (INK, DARK[INK]),
    "raised": (COOL, DARK[COOL]),
    "rule": (GRID, DARK[GRID]),
    "muted": ("#4F5966", "#AAB4C0"),
    "good": ("#1B6B2F", "#7FD494"),
    "doubt": ("#8A4B00", "#FFB066"),
    "bad": ("#A31515", "#FF9C94"),
}
_CAPTIONS = {
    "friction": "Friction force over displacement: what the recorded cycle leaves after spring, inertia and viscous "
    "damping are taken off, and the loop of the fitted oscillator. A dot marks where slip begins.",
    "cycles": "Each record folded onto one cycle of the drive, with the fitted oscillator; below, what the fit leaves, "
    "in standard deviations of the noise. A pattern there is what the model does not explain.",
    "decays": "Each decay with the fitted oscillator; below, what the fit leaves, in standard deviations of the noise. "
    "A pattern there is what the model does not explain.",
    "balance": "Energy balance: each marker is a cycle, and the line is what friction and damping take. Right: what "
    "each row leaves, in standard deviations.",
    "loops": "Acceleration over displacement. The steep line after a reversal is the contact giving way before it "
    "slips; its slope gives the contact stiffness.",
}
"""What each picture shows, in the order of the report."""
_CONTACT = "contact stiffness"


def report(outcome: Outcome, document: Mapping[str, Any], drawings: Mapping[str, str]) -> str:
    """The report of one set of records, as HTML.

    document : of the same outcome.   drawings : picture → SVG as `figures.style.save_svg` writes it.
    """
    answer = next(iter(outcome.answers.values()))
    count = len(outcome.sources)
    names = listed([_short(name) for name in outcome.sources]) if count < 4 else f"{count} records"
    shown = [name for name in _CAPTIONS if name in drawings]
    parts = [
        verdict(answer, outcome.warnings),
        paragraph(f"{outcome.head}."),
        _numbers(answer),
        *(bulleted("What limits the answer", _limits(outcome, answer.name))),
        *(bulleted("What to check and do next", _next(outcome, document, answer))),
        "<h2>What the records show</h2>",
        *(figure(drawings[name], _CAPTIONS[name], outcome.pictures[name].words) for name in shown),
        *_levels(document["damping"]),
        *_sensitivities(document),
        "<h2>Other ways of evaluation</h2>",
        paragraph(
            "The first line is the answer, and the others check it from the same records: “maximum likelihood” fits "
            "one oscillator to all of them, every other way balances the energy of a cycle. A star marks a note."
        ),
        wide(answers_table(outcome.answers), "answers"),
        _items(_limits(outcome, answer.name, of_others=True)),
        *_laws(outcome),
        *_origin(document),
    ]
    return page(f"Friction and damping from {names}", parts)


# --- pieces ---------------------------------------------------------------------------------------


def page(title: str, parts: Iterable[str]) -> str:
    """A whole page: light or dark as the reader has it, light in print."""
    light, dark = (
        " ".join(f"--{name}: {pair[mode]};" for name, pair in _COLOURS.items()) for mode in (0, 1)
    )
    css = files(__package__).joinpath("report.css").read_text(encoding="utf-8")
    return (
        '<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>{escape(title)}</title>\n<style>\n:root {{ color-scheme: light dark; {light} }}\n"
        f"@media screen and (prefers-color-scheme: dark) {{ :root {{ {dark} }} }}\n{css}</style>\n"
        f"</head>\n<body>\n<main>\n<h1>{in_html(title)}</h1>\n"
        + "\n".join(parts)
        + f"\n<footer>dampbalance {__version__}. The same records and settings give this same file.</footer>\n"
        "</main>\n</body>\n</html>\n"
    )


def paragraph(text: str, kind: str = "") -> str:
    """Text as a paragraph, its symbols set.   kind : class of CSS."""
    of = f' class="{kind}"' if kind else ""
    return f"<p{of}>{in_html(text)}</p>"


def table(
    heads: Sequence[str], rows: Iterable[Sequence[str]], label: str, words: Sequence[int] = ()
) -> str:
    """A table; cells are HTML.   label : what it holds.   words : numbers of the columns, after the first, of text."""

    def kind(column: int) -> str:
        return "words" if column in words else "num"

    top = "".join(
        f'<th scope="col"{f" class={kind(i)!r}" if i else ""}>{in_html(head)}</th>'
        for i, head in enumerate(heads)
    )
    body = "\n".join(
        f'<tr><th scope="row">{first}</th>'
        + "".join(f'<td class="{kind(i)}">{cell}</td>' for i, cell in enumerate(cells, 1))
        + "</tr>"
        for first, *cells in rows
    )
    return wide(f"<table><thead><tr>{top}</tr></thead>\n<tbody>\n{body}\n</tbody></table>", label)


def wide(inner: str, label: str) -> str:
    """What may be wider than the screen, and is then scrolled, also by keyboard.   label : what it holds."""
    return (
        f'<div class="wide" role="region" tabindex="0" aria-label="{escape(label)}">{inner}</div>'
    )


def figure(svg: str, caption: str, words: str) -> str:
    """A picture inside the page, which follows light and dark by itself.   words : for those who cannot see it."""
    data = base64.b64encode(follows_the_screen(svg).encode()).decode()
    picture = f'<img alt="{escape(words)}" src="data:image/svg+xml;base64,{data}">'
    shown = wide(picture, f"picture: {caption}")
    return f"<figure><figcaption>{in_html(caption)}</figcaption>{shown}</figure>"


def word(verdict: str) -> str:
    """A verdict in its colour."""
    sign = {USABLE: "✓", DOUBTFUL: "?", NONE: "✗"}.get(verdict, "✗")
    return f'<span class="verdict {escape(verdict)}">{sign} {escape(verdict)}</span>'


def bulleted(title: str, sentences: Sequence[str]) -> Iterator[str]:
    """A list of sentences below a title; nothing where there are none."""
    if sentences:
        yield f"<h2>{title}</h2>\n{_items(sentences)}"


def _items(sentences: Sequence[str]) -> str:
    items = "\n".join(f"<li>{in_html(_sentence(one))}</li>" for one in sentences)
    return f"<ul>\n{items}\n</ul>" if sentences else ""


def _sentence(text: str) -> str:
    """Words as a sentence; one that begins with a symbol or a file keeps its letter."""
    first = text.split(" ")[0].rstrip(":,")
    capital = first.isalpha() and (len(first) > 1 or first == "a")
    return (text[0].upper() if capital else text[0]) + text[1:].rstrip(".") + "."


# --- the answer -----------------------------------------------------------------------------------


def verdict(answer: Answer, warnings: Sequence[Remark]) -> str:
    """The whole result in a sentence: which numbers can be used, with their values, and the first reason where others
    cannot."""
    groups: dict[str, list[str]] = {USABLE: [], DOUBTFUL: [], NONE: []}
    for symbol, one in answer.verdicts.items():
        groups[one.verdict].append(symbol)
    usable, doubtful, none = groups.values()
    parts = []
    if usable:
        these = "can be used as they stand" if len(usable) > 1 else "can be used as it stands"
        parts.append(f"{_values(answer, usable)} {these}")
    if doubtful:
        are = "are doubtful" if len(doubtful) > 1 else "is doubtful"
        parts.append(f"{_values(answer, doubtful)} {are}")
    if none:
        parts.append(f"{listed(none)} cannot be had from these records")
    kind = DOUBTFUL if usable and (doubtful or none) else next(k for k, of in groups.items() if of)
    if kind != USABLE:
        casting = [one for one in warnings if any(one.doubts.values())] or [*answer.notes]
        reasons = [_clause(one.words).partition(":")[0] + _of(one.source) for one in casting]
        reasons += [_clause(one.reason) for one in answer.verdicts.values() if one.reason]
        parts.append(f"the first reason: {reasons[0]}")
    return paragraph(_sentence("; ".join(parts)), f"lead {kind}")


def _clause(text: str) -> str:
    """What a sentence says first."""
    return text.partition(";")[0]


def _of(source: str) -> str:
    return f" ({_short(source)})" if source else ""


def _short(source: str) -> str:
    """The name of a file without its folder; of a record from elsewhere all of it, whatever slashes it has."""
    path = PurePath(source)
    return visible(path.name if path.suffix else source)


def _values(answer: Answer, symbols: Sequence[str]) -> str:
    texts = []
    for symbol in symbols:
        p = answer.parameters[symbol]
        share = f" (±\N{NO-BREAK SPACE}{_part(p)})" if _half(p) < 1.0 else ""
        value = value_of(p)
        equal = "" if value.startswith(">") else "= "
        texts.append(f"{symbol} {equal}{value} {unit_of(symbol)}".rstrip() + share)
    return listed(texts)


def _numbers(answer: Answer) -> str:
    """The numbers with their intervals and verdicts, and why one is not usable."""
    rows = []
    for symbol, (verdict, reason) in answer.verdicts.items():
        p, unit = answer.parameters[symbol], f" {unit_of(symbol)}"
        known = not math.isnan(p.value)
        rows.append(
            [
                f"{in_html(_words(symbol))}, {in_html(symbol)}",
                escape(value_of(p) + unit * known),
                escape(interval_of(p)),
                escape(f"± {_part(p)}") if interval_of(p) != "–" else "–",
                word(verdict),
                in_html(_clause(reason)) + " …" * (";" in reason)
                if reason
                else "nothing speaks against it",
            ]
        )
    heads = ["quantity", "value", "95 % interval", "half width", "verdict", "why"]
    return table(heads, rows, "the numbers", words=[5])


def _words(symbol: str) -> str:
    """What a symbol stands for."""
    return _CONTACT if symbol == "K_z" else term(parted(symbol)[0]).words


def _half(p: ParameterEstimate) -> float:
    """Half the width of an interval, as a part of its value."""
    return 0.5 * (p.interval.high - p.interval.low) / abs(p.value) if p.value else math.nan


def _part(p: ParameterEstimate) -> str:
    return f"{number(100.0 * _half(p), 2)}\N{NO-BREAK SPACE}%"


def _limits(outcome: Outcome, name: str, of_others: bool = False) -> list[str]:
    """What limits the answer of this name, or what limits the others only."""
    return [
        limit.words if limit.of == (name,) else in_a_sentence(limit, outcome.sources)
        for limit in limits(outcome.answers, outcome.warnings)
        if (limit.kind == "approaches" and name not in limit.of) == of_others
    ]


def _next(outcome: Outcome, document: Mapping[str, Any], answer: Answer) -> list[str]:
    """What helps most: the fault that the numbers feel most, against what their intervals allow, and the rest of what
    the records cannot test."""
    felt = [("", 1.0)]
    for effect in document["sensitivities"].values():
        for symbol, p in answer.parameters.items():
            change, half = abs(effect.get(f"{symbol}_percent") or 0.0) / 100.0, _half(p)
            if half > 0.0 and math.isfinite(half):
                words = f"{effect['fault']}, {symbol} is off by {percent(change)}, and its interval"
                felt.append((f"check first: if {words} shows {_part(p)} only", change / half))
    return [*filter(None, [max(felt, key=lambda one: one[1])[0]]), *outcome.rig]


# --- what follows from it -------------------------------------------------------------------------


def _levels(damping: Mapping[str, Any]) -> Iterator[str]:
    """Damping ratio, loss factor, quality factor and equivalent viscous damping of each level."""
    levels = damping["levels"]
    if not levels:
        return
    yield "<h2>Damping of each level</h2>"
    ratio = damping["damping_ratio"]
    zeta = (
        ""
        if ratio is None
        else f"The damping ratio of c alone is ζ = c/(2√(km)) = {percent(ratio)}. "
    )
    said = paragraph(
        f"{zeta}Friction takes less of a large motion than of a small one, so the numbers below belong to the "
        "amplitude next to them: use them to compare with other rigs, or in a linear model at that amplitude. W is the "
        "energy lost in a cycle, c_eq = W/(πωX²), ζ_eq = c_eq/(2√(km)), η = W/(πkX²) and Q = 1/η; k is the spring’s."
    )
    heads = [
        "level",
        "X (mm)",
        "f (Hz)",
        "W (mJ)",
        "of it friction",
        "c_eq (N s/m)",
        "ζ_eq",
        "η",
        "Q",
    ]
    lines = table(
        heads,
        (
            [
                escape(_short(level["level"])),
                _figures(level["X_m"], 1e3),
                _figures(level["frequency_Hz"]),
                _figures(level["W_J"], 1e3),
                _share(level["friction_share"]),
                _figures(level["equivalent_damping_N_s_per_m"]),
                _share(level["equivalent_damping_ratio"]),
                _figures(level["loss_factor"]),
                _figures(level["Q"]),
            ]
            for level in levels
        ),
        "damping of each level",
    )
    yield f"{said}\n{lines}".replace("_eq", "<sub>eq</sub>")


def _figures(value: float | None, factor: float = 1.0) -> str:
    return escape(number(math.nan if value is None else factor * value, 4))


def _share(value: float | None) -> str:
    return escape(percent(math.nan if value is None else value))


def _sensitivities(document: Mapping[str, Any]) -> Iterator[str]:
    """What faults of calibration and timing would change, which the records hardly show."""
    effects = document["sensitivities"]
    if not effects:
        return
    columns = list(dict.fromkeys(key for of in effects.values() for key in of if key != "fault"))
    rows = (
        [in_html(of["fault"]), *(_change(of.get(column)) for column in columns)]
        for of in effects.values()
    )
    yield "<h2>What a fault of the measurement would change</h2>"
    yield paragraph(
        "By how much each number would be off if the fault were there and nobody knew; of another size, in proportion. "
        f"For: {document['sensitivities_of']}."
    )
    yield table(
        ["if", *(column.removesuffix("_percent") for column in columns)], rows, "effect of faults"
    )


def _change(change: float | None) -> str:
    return escape(signed_percent(math.nan if change is None else 0.01 * round(change, 3)))


def _laws(outcome: Outcome) -> Iterator[str]:
    """The comparison of damping laws, where one was asked for."""
    if lines := comparison(outcome.laws):
        yield f"<h2>Damping laws compared</h2>\n<pre>{escape(chr(10).join(lines))}</pre>"


def _origin(document: Mapping[str, Any]) -> Iterator[str]:
    """Records with their digests, and all settings."""
    yield "<h2>Records and settings</h2>"
    rows = (
        [
            escape(visible(record["record"])),
            f'<span class="digest">{escape(record.get("sha256") or "not from a file")}</span>',
            escape(visible(str(record.get("mapping") or "–"))),
        ]
        for record in document["records"]
    )
    yield table(["record", "SHA-256", "mapping"], rows, "records", words=[1, 2])
    settings = (
        [f"<code>{escape(name)}</code>", escape(_shown(value))]
        for name, value in dotted(document["options"])
        if value not in (None, [], {})
    )
    yield table(["setting", "value"], settings, "settings", words=[1])


def _shown(value: Any) -> str:
    if isinstance(value, list | tuple):
        return ", ".join(map(str, value))
    if isinstance(value, bool):
        return "yes" if value else "no"
    return visible(f"{value:.10g}" if isinstance(value, float) else str(value))
