"""A finding that says what a test wants, with an effect of any size."""

from __future__ import annotations

from dampbalance.findings.finding import Finding
from dampbalance.findings.sentences import SENTENCES, Sentence

TOY = "any words"
SENTENCES[TOY] = Sentence("{words}")


def toy(words, effect=None, of=""):
    """A finding that says these words."""
    return Finding(TOY, {"words": words}, effect or {}, of)
