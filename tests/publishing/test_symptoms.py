"""The page of symptoms: the fault of its records is what `identify` names, and a report leads to its section."""

from __future__ import annotations

import re
import sys
from importlib import import_module

import pytest

from dampbalance.findings.sentences import SENTENCES
from dampbalance.identification.report import address
from folders import ROOT

pytestmark = pytest.mark.slow

SITE = ROOT / "paper/site"
sys.path.append(str(SITE / "symptoms"))
lab = import_module("lab")


def test_each_symptom_has_records_and_a_section():
    sections = re.findall(r"^\((\S+)\)=$", (SITE / "howto/symptoms.md").read_text("utf-8"), re.M)
    assert {*sections} == {one.page for one in SENTENCES.values()} - {""}
    assert sorted(sections) == sorted(name.replace("_", "-") for name in lab.FAULTS)


@pytest.mark.parametrize("name", lab.FAULTS)
def test_the_fault_put_into_records_is_the_one_that_is_named(name):
    sentences, _ = lab.sentences(name)
    assert sentences


def test_sound_records_show_none_and_their_truth_and_others_lead_to_their_section():
    sound = lab.identified(lab.Fault("none"))
    assert "symptoms.html" not in sound.report()
    for symbol in ("F_k", "c", "K_z"):
        low, high = sound.intervals[symbol]
        # an interval of 95 % may miss it: twice its width does not
        assert abs(getattr(lab.TRUTH, symbol) - 0.5 * (low + high)) < high - low
    assert address("clipped") in lab.identified(lab.FAULTS["clipped"]).report()
