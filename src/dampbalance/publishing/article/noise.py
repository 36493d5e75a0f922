"""The values of the article's section on noise: many experiments, by approach, drive frequency and level of noise."""

from __future__ import annotations

from ...balance import TERMS
from .book import Book
from .style import Style

SUMMARY = "results/studies/noise/summary.csv"
MANIFEST = "results/studies/noise/manifest.json"

# Line of the article's tables → the fit of the study, the model of the contact, and the weights of the rows.
FITS = {
    "direct": ("direct", "", "", "compliant", "weighted"),
    "equal": ("direct", "", "", "compliant", "equal"),
    "fourier": ("fourier", "", "", "compliant", "weighted"),
    "fundamental": ("X_s", "fundamental", "individual", "compliant", "weighted"),
    "reversal": ("X_s", "reversal", "individual", "compliant", "weighted"),
    "rigid": ("direct", "", "", "rigid", "weighted"),
}
OF_FIT = ("approach", "phase", "sharing", "contact", "weights")
# Number of a cell → column of the summary, and how it is printed.
CELLS = {
    "p95": ("p95_percent", Style("significant", 2)),
    "bias": ("bias_over_standard_error", Style("fixed", 1, signed=True)),
    "coverage": ("coverage_percent", Style("fixed")),
    "low": ("coverage_low_percent", Style("fixed")),
    "high": ("coverage_high_percent", Style("fixed")),
}
PLAIN, COUNT = Style("plain"), Style("fixed")


def noise(book: Book) -> dict[str, list[str]]:
    """Enter what the experiments of the noise study say, and how they were made; return what its tables run over."""
    rows = book.rows(SUMMARY)
    frequencies, levels = (
        list(dict.fromkeys(row[name] for row in rows)) for name in ("frequency_hz", "noise")
    )
    first = {"quantity": "F_k", "fit": "least_squares", **_of("direct")}
    for hz in frequencies:
        at = first | {"frequency_hz": hz, "noise": levels[0]}
        book.cell(f"noise.f.{hz}", SUMMARY, at, "frequency_hz", PLAIN, "Hz")
    for level in levels:
        at = first | {"frequency_hz": frequencies[0], "noise": level}
        book.cell(f"noise.level.{level}", SUMMARY, at, "noise", Style("plain", scale="1e2"), "%")
    book.cell("noise.runs", SUMMARY, at, "runs", COUNT)
    for name, unit in {"sampling_hz": "Hz", "cycles": "", "replicates": "", "seed": ""}.items():
        book.item(f"noise.{name}", MANIFEST, f"/settings/route/{name}", PLAIN, unit)
    for hz in frequencies:
        for level in levels:
            for line in FITS:
                for term in TERMS:
                    at = {"frequency_hz": hz, "noise": level, "quantity": term, **_of(line)}
                    key = f"noise.{hz}.{level}.{line}.{term}"
                    for cell, (column, style) in CELLS.items():
                        book.cell(f"{key}.{cell}", SUMMARY, at, column, style)
    return {"frequencies": frequencies, "levels": levels, "lines": list(FITS)}


def _of(line: str) -> dict[str, str]:
    """The entries of the summary that tell the fit of a line."""
    return dict(zip(OF_FIT, FITS[line], strict=True))
