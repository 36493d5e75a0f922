"""A finding is one line in the table of sentences: screen, details, report, document and table then have it."""

from __future__ import annotations

from dataclasses import replace

import pytest

from dampbalance import identify
from dampbalance.findings.finding import Finding
from dampbalance.findings.sentences import SENTENCES, Sentence
from identification.levels import measured
from paper_case import PAPER
from toys import toy


@pytest.fixture
def sound():
    return identify(measured(noise=0.003, cycles=20.0), PAPER.k)


def test_a_finding_is_a_line_in_the_table(sound, monkeypatch):
    toy = Sentence("a cable hides {part:percent} of {F_k}", "pull it off", page="cable")
    monkeypatch.setitem(SENTENCES, "cable", toy)
    cable = Finding("cable", {"part": 0.25}, {"F_k": 0.25}, of=sound.sources[0])
    found = replace(sound, odd=(*sound.odd, cable))
    words = "a cable hides 25 % of F_k"
    assert found.verdicts["F_k"].verdict == "doubtful"
    assert found.verdicts["c"].verdict == sound.verdicts["c"].verdict
    for text in (found.screen(400), found.text()):
        assert f"{words}; pull it off" in text
    report = found.report()
    assert "pull it off" in report
    assert "howto/symptoms.html#cable" in report
    (entry,) = (one for one in found.document()["findings"] if one["code"] == "cable")
    assert entry["numbers"] == {"part": 0.25}
    assert entry["effect"] == {"F_k": 0.25}
    assert entry["of"] == sound.sources[0]
    assert entry["sentence"].startswith(words)
    assert cable in found.findings


def test_a_verdict_depends_on_effects_and_not_on_the_order(sound):
    some = [
        toy(word, effect) for word, effect in (("a", {"F_k": 0.3}), ("b", {"": 0.06}), ("c", {}))
    ]
    verdicts = [
        {s: v[:3] for s, v in replace(sound, odd=tuple(order)).answer.verdicts.items()}
        for order in (some, some[::-1])
    ]
    assert verdicts[0] == verdicts[1]
