"""Symptoms: what can make a verdict doubtful, by which words it shows in a result, and where the site explains it.

The page `paper/site/howto/symptoms.md` has a section for each, with a picture from synthetic records. A departure of
the model (`causes.CAUSES`) is recognised by its own words, every other symptom by a part of its sentence.
"""

from __future__ import annotations

from collections.abc import Iterable

from .causes import CAUSES

PAGE = "howto/symptoms"

SYMPTOMS = {
    name: max(cause.words.split("{}"), key=len).strip(" ,") for name, cause in CAUSES.items()
}
SYMPTOMS |= {
    "frame": "and was taken for",
    "unsettled": "is not steady",
    "clipped": "is clipped",
    "spikes": "left out; first cycle",
    "bits": "effective bits",
    "base": "is not harmonic",
    "asymmetric": "is not symmetric",
    "frequency": "oscillates at",
    "exchanged": "leads the excitation",
    "mass": "more than their uncertainties allow",
    "stuck": "are those of a linear oscillator",
    "alike": "can hardly be distinguished by the balance",
    "unresolved": "do not resolve the onset of slip",
}
"""Name of each symptom, its anchor on the page → words of the sentences that name it."""


def symptoms_in(sentences: Iterable[str]) -> list[str]:
    """Return the names of the symptoms that sentences of a result show, in the order of the sentences."""
    pairs = ((name, words) for words in sentences for name in SYMPTOMS)
    return [*dict.fromkeys(name for name, words in pairs if SYMPTOMS[name] in words)]


def address(name: str) -> str:
    """Return where the site explains a symptom, relative to its first page."""
    return f"{PAGE}.html#{name.replace('_', '-')}"
