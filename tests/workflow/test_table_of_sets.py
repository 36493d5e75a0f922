"""One table for several sets of records: its lines, its order, and the errors of sets that could not be identified."""

from __future__ import annotations

import runpy

import pandas as pd

from folders import ROOT

COLUMNS = "approach,F_k_N,F_k_low_N,F_k_high_N,K_z_N_per_m,F_k_verdict,K_z_verdict,no_answer"
SETS = {
    "late": ["direct,1.28,1.27,1.29,30500,usable,none,", "mean of pairs,1.3,1.2,1.4,,,,"],
    "loud": ["direct,9,1,8,,doubtful,none,clipped"],
    "early": ["direct,2,1.98,2.02,40000,usable,usable,"],
}


def test_each_set_has_a_line_with_its_answer_and_a_failure_its_error(tmp_path):
    for name, rows in SETS.items():
        (tmp_path / name).mkdir()
        text = "\n".join([COLUMNS, *rows, ""])
        (tmp_path / name / "identification.csv").write_text(text, encoding="utf-8")
    script = runpy.run_path(str(ROOT / "workflow/scripts/measured/measured.py"))
    why = "broken.csv: no number"
    said = script["summarise"](tmp_path, {"late": "", "broken": why, "loud": "", "early": ""})
    assert said == (tmp_path / "summary.txt").read_text(encoding="utf-8")
    lines = said.splitlines()
    assert lines[0].startswith("2 of 4 sets of records identified in ")
    assert [line.split()[:3] for line in lines[3:7]] == [
        ["late", "direct", "1.28"],
        ["broken", "–", "–"],
        ["loud", "direct", "9"],
        ["early", "direct", "2"],
    ]
    assert lines[-2:] == [f"broken: {why}", "loud: no answer: clipped"]
    table = pd.read_csv(tmp_path / "identification.csv")
    assert [*table["set"]] == ["late", "late", "broken", "loud", "early"]
    assert [*table["error"].fillna("")] == ["", "", why, "", ""]
    assert [*table["F_k_N"].dropna()] == [1.28, 1.3, 9.0, 2.0]
