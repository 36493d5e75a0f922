"""The values of the article's section on noise that are no facts of the study: its settings, and the rigid model."""

from __future__ import annotations

from .book import Book
from .style import Style

SUMMARY = "results/studies/noise/summary.csv"
MANIFEST = "results/studies/noise/manifest.json"

RIGID = {"approach": "direct", "contact": "rigid", "weights": "weighted", "fit": "least_squares"}
LEVELS = ("0.001", "0.01")
"""Noise over signal of which the text speaks."""


def noise(book: Book) -> None:
    """Enter how the experiments of the noise study were made, and how the rigid model fares in them."""
    plain = Style("plain")
    for name, unit in {"sampling_hz": "Hz", "cycles": "", "replicates": "", "seed": ""}.items():
        book.item(f"noise.{name}", MANIFEST, f"/settings/route/{name}", plain, unit)
    for hz in dict.fromkeys(row["frequency_hz"] for row in book.rows(SUMMARY)):
        for level in LEVELS:
            at = {"frequency_hz": hz, "noise": level, "quantity": "F_k", **RIGID}
            key, signed = f"noise.{hz}.{level}.rigid", Style("fixed", 1, signed=True)
            book.cell(f"{key}.bias", SUMMARY, at, "bias_over_standard_error", signed)
            book.cell(f"{key}.coverage", SUMMARY, at, "coverage_percent", Style("fixed"), "%")
    for level in LEVELS:
        first = at | {"noise": level}
        book.cell(f"noise.level.{level}", SUMMARY, first, "noise", Style("plain", scale="1e2"), "%")
    book.cell("noise.runs", SUMMARY, at, "runs", Style("fixed"))
