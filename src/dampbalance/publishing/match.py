"""A picture of the match: for every part of the paper, which share of its printed numbers earns which verdict."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from xml.sax.saxutils import escape

from ..replication.claims.verdicts import VERDICTS, Count
from .colours import css_variables, variable

# px: the picture, room for the parts' names, room for their totals
PICTURE_WIDTH, LEFT, RIGHT_MARGIN = 760, 100, 60
# px: a bar, from bar to bar, above the first, from the last to the legend
BAR_HEIGHT, ROW_STEP, TOP_MARGIN, BELOW = 26, 36, 44, 20
GAP = 2  # px between two verdicts: they keep apart without colour
SYMBOL_FITS = 44  # px: a narrower stretch holds its count only
NARROW = 9  # px: a stretch that is narrower still holds nothing
LEGEND_COLUMNS, LEGEND_STEP = 4, 28  # entries in a row; px from row to row


def match_picture(counts: Sequence[Count]) -> str:
    """Return the picture as SVG with text that can be read aloud, light or dark as the reader has it.

    counts : `replication.claims.verdicts.counts`, the last one of all parts.
    """
    shown = [count for count in counts if count.computed]
    legend = TOP_MARGIN + ROW_STEP * len(shown) + BELOW
    height = legend + LEGEND_STEP * math.ceil(len(VERDICTS) / LEGEND_COLUMNS)
    total = counts[-1]
    some = ", ".join(f"{n} {name}" for name, n in total.of_verdict.items() if n)
    none = "".join(f"; none {name}" for name, n in total.of_verdict.items() if not n)
    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {PICTURE_WIDTH} {height}" '
        f'width="{PICTURE_WIDTH}" height="{height}" '
        'role="img" aria-labelledby="title description">',
        '<title id="title">How the printed numbers fare</title>',
        f'<desc id="description">Of {total.computed} computed numbers: {escape(some + none)}.</desc>',
        "<style>",
        f":root {{ {css_variables('light')} }}",
        f"@media (prefers-color-scheme: dark) {{ :root {{ {css_variables('dark')} }} }}",
        "text { font: 14px system-ui, 'Segoe UI', Roboto, 'DejaVu Sans', sans-serif; fill: var(--ink); }",
        ".in { fill: var(--on-verdict); text-anchor: middle; font-weight: 600; }",
        ".part { text-anchor: end; } .total { fill: var(--muted); } .all { font-weight: 600; }",
        "</style>",
        f'<rect width="{PICTURE_WIDTH}" height="{height}" fill="{variable("paper")}"/>',
        f'<text class="all" x="{LEFT}" y="22">{total.computed} computed numbers, by the verdict of the rebuild</text>',
    ]
    for row, count in enumerate(shown):
        lines += _bar(
            count, TOP_MARGIN + ROW_STEP * row + (6 if count is total else 0), last=count is total
        )
    return "\n".join([*lines, *_legend(legend + 15), "</svg>", ""])


def _bar(count: Count, top: int, last: bool) -> Iterator[str]:
    """Draw one part: its name, a stretch per verdict that occurs, and how many numbers it has."""
    middle, weight, part = top + BAR_HEIGHT // 2 + 5, " all" if last else "", escape(count.part)
    yield f'<text class="part{weight}" x="{LEFT - 12}" y="{middle}">{part}</text>'
    before, room = 0, PICTURE_WIDTH - LEFT - RIGHT_MARGIN
    for name, n in count.of_verdict.items():
        verdict, left = VERDICTS[name], LEFT + room * before / count.computed
        width = room * n / count.computed - GAP
        before += n
        if n:
            yield (
                f'<rect x="{left:.1f}" y="{top}" width="{width:.1f}" height="{BAR_HEIGHT}" rx="2" '
                f'fill="{variable(verdict.css)}"><title>{part}: {n} {name}</title></rect>'
            )
        if width >= NARROW:
            text = f"{verdict.mark} {n}" if width >= SYMBOL_FITS else f"{n}"
            yield f'<text class="in" x="{left + 0.5 * width:.1f}" y="{middle}">{text}</text>'
    right = PICTURE_WIDTH - RIGHT_MARGIN + 10
    yield f'<text class="total{weight}" x="{right}" y="{middle}">{count.computed}</text>'


def _legend(first: int) -> Iterator[str]:
    """Draw what symbol and colour stand for. first : px, base line of its first row."""
    width = (PICTURE_WIDTH - LEFT) // LEGEND_COLUMNS
    for number, verdict in enumerate(VERDICTS.values()):
        row, column = divmod(number, LEGEND_COLUMNS)
        left, base, fill = LEFT + width * column, first + LEGEND_STEP * row, variable(verdict.css)
        yield f'<rect x="{left}" y="{base - 15}" width="24" height="20" rx="2" fill="{fill}"/>'
        yield f'<text class="in" x="{left + 12}" y="{base}">{verdict.mark}</text>'
        yield f'<text x="{left + 31}" y="{base}">{verdict.name}</text>'
