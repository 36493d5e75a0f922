"""One table for several sets of records: its lines, its order, and the errors of sets that could not be identified."""

from __future__ import annotations

import pandas as pd

from dampbalance.identification.table_of_sets import summarise

COLUMNS = "approach,F_k_N,F_k_low_N,F_k_high_N,K_z_N_per_m,K_z_low_N_per_m,K_z_high_N_per_m,F_k_verdict,K_z_verdict"
STIFF = "maximum likelihood,1.28,1.27,1.29,30500,30000,,usable,none"  # K_z is unbounded above
OTHER = "direct,1.3,1.2,1.4,,,,usable,none"
LOOSE = "direct,2,1.98,2.02,40000,39000,41000,usable,usable"


def test_each_set_has_a_line_with_its_answer_and_a_failure_its_error(tmp_path):
    for name, rows in {"late": [STIFF, OTHER], "early": [LOOSE]}.items():
        (tmp_path / name).mkdir()
        text = "\n".join([COLUMNS, *rows, ""])
        (tmp_path / name / "identification.csv").write_text(text, encoding="utf-8")
    said = summarise(tmp_path, {"late": "", "broken": "broken.csv: no number", "early": ""})
    assert said == (tmp_path / "summary.txt").read_text(encoding="utf-8")
    lines = said.splitlines()
    assert lines[0].startswith("2 of 3 sets of records identified in ")
    assert [line.split("  ")[0].strip() for line in lines[3:6]] == ["late", "broken", "early"]
    assert "1.280 [1.270, 1.290]" in lines[3]  # two digits of the half width
    assert "> 30000" in lines[3]
    assert lines[3].endswith("usable: F_k; none: K_z")
    assert lines[4].endswith("not identified")
    assert lines[5].endswith("usable")
    assert lines[-1] == "broken: broken.csv: no number"
    table = pd.read_csv(tmp_path / "identification.csv")
    assert [*table["set"]] == [
        "late",
        "late",
        "broken",
        "early",
    ]  # every approach, and a line for an error
    assert [*table["error"].fillna("")] == ["", "", "broken.csv: no number", ""]
    assert [*table["F_k_N"].dropna()] == [1.28, 1.3, 2.0]


def test_a_set_without_an_answer_is_listed_with_its_cause(tmp_path):
    heads = f"{COLUMNS},F_k_within_percent,K_z_within_percent,no_answer"
    sets = {"loud": "direct,9,1,8,,,,doubtful,none,,,clipped", "sound": f"{LOOSE},1,2.5,"}
    for name, row in sets.items():
        (tmp_path / name).mkdir()
        (tmp_path / name / "identification.csv").write_text(f"{heads}\n{row}\n", encoding="utf-8")
    head, *_, loud, sound, _, last = summarise(tmp_path, dict.fromkeys(sets, "")).splitlines()
    assert head.startswith("1 of 2 sets of records identified in ")
    assert loud.endswith("no answer")
    assert sound.endswith("usable within 2.5 %")
    assert last == "loud: no answer: clipped"
