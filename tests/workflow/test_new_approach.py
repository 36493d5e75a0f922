"""A new approach is one function and one entry, a new term of a law is one entry: everything else follows.

A copy of the project gets a term in `law/terms.py`, and in `balance.py` an approach that has it.
Tables, figures, page, a study, an identification and a simulation then know them, and nothing else was edited.
"""

from __future__ import annotations

import json
import sys

import pandas as pd
import pytest
import yaml

from dampbalance.publishing.page.report import LARGEST_PAGE
from folders import restored
from processes import output_of

pytestmark = pytest.mark.slow

TERM = """        Term("c_4", lambda v, w, k, omega: np.abs(v) ** 3 * v, "quartic damping",
             "N s⁴/m⁴", "b_4", "m⁵/s⁴", 4),
"""
# Direct integration with a quartic damper in addition. There is none.
TOY = (
    """def quartic(features: Features, k: ArrayLike) -> Rows:
    rows = direct(features, k)
    return Rows({**rows.terms, "c_4": 32.0 / 15.0 * features.omega**4 * features.X**5}, rows.W)


""",
    """        Approach("toy", quartic, "with a toy", terms=("F_k", "c", "c_4")),
""",
)
# As CONTRIBUTING.md has it, without a term.
ALONE = (
    """def alone(features: Features, k: ArrayLike) -> Rows:
    return Rows({"F_k": 4.0 * features.X, "c": features.b}, features.W)


""",
    """        Approach("alone", alone, "with nothing else"),
""",
)


def edited(file, *insertions):
    """A source file with texts before the only place that each of other texts has in it."""
    text = file.read_text(encoding="utf-8")
    for place, inserted in insertions:
        before, after = text.split(place)
        text = f"{before}{inserted}{place}{after}"
    file.write_text(text, encoding="utf-8")


def with_approach(copy, function, entry, *more):
    """A copy of the project with one function and one entry."""
    places = ("APPROACHES: dict[str, Approach] = {", '    )\n}\n"""The built-in approaches')
    file = copy.folder / "src/dampbalance/balance.py"
    edited(file, *zip(places, (function, entry), strict=True), *more)


CASE = {
    "case": "toy",
    "excitation": {
        "frequencies": [{"name": "resonance", "hz": 4.92}],
        "levels_m": [0.004, 0.006, 0.008, 0.012],
    },
    "estimation": {"pairs": [[1, 2]]},
    "as_published": {"step_s": 2.0e-5, "cycles": 6},
    "published": None,
}
TOY_CASE = ("--configfile", "toy.yaml")
STUDY = {
    "title": "A toy",
    "axes": [{"zeta": {"from": 0.1, "to": 0.9, "count": 5}}],
    "levels_m": [0.004, 0.006, 0.008, 0.012],
    "estimation": {"approaches": ["direct", "toy"]},
    "columns": ["parameters", "estimates", "errors", "residuals"],
    "figure": {"kind": "curves", "x": "zeta"},
}
TEXT = """F_k is off by {{ errors("F_k", "toy").largest | percent }} at most."""


@pytest.fixture(scope="module")
def extended(checkout):
    copy = checkout()
    with_approach(copy, *TOY, (')}\n"""The terms of the balance (6)', ', "c_4"'))
    edited(copy.folder / "src/dampbalance/law/terms.py", ('    )\n}\n"""The terms by symbol', TERM))
    for file, document in (("toy.yaml", CASE), ("config/studies/toy.yaml", STUDY)):
        text = yaml.safe_dump(document, allow_unicode=True)
        (copy.folder / file).write_text(text, encoding="utf-8")
    (copy.folder / "config/studies/toy.md.j2").write_text(TEXT, encoding="utf-8")
    return copy


def test_the_pipeline_shows_it(extended):
    results = extended.folder / "results/toy"
    made = ("estimates/exact/resonance.csv", "tables/approaches.md", "figures/estimation_error.svg")
    extended.made(*(f"results/toy/{name}" for name in made), *TOY_CASE)
    table = pd.read_csv(results / "estimates/exact/resonance.csv")
    fit = table[(table["approach"] == "toy") & (table["kind"] == "least_squares")].iloc[0]
    # the exact balance closes without the third term
    assert fit["F_k_N"] == pytest.approx(1.28, rel=1e-9)
    assert fit["c_N_s_per_m"] == pytest.approx(90.0, rel=1e-9)
    assert abs(fit["c_4_N_s4_per_m4"]) < 1e-6
    pairs = table[(table["approach"] == "toy") & (table["kind"] == "pair")]
    assert pairs["F_k_N"].isna().all()
    assert pairs["note"].str.contains("two levels do not distinguish F_k, c and c_4").all()
    assert "toy" in (results / "tables/approaches.md").read_text(encoding="utf-8")
    assert "with a toy" in (results / "figures/estimation_error.svg").read_text(encoding="utf-8")


def test_the_page_shows_it(extended):
    extended.made("results/toy/report.html", *TOY_CASE)
    page = extended.folder / "results/toy/report.html"
    assert "with a toy" in page.read_text(encoding="utf-8")


def test_the_page_of_the_paper_s_case_is_built_with_an_approach_more(checkout):
    copy = checkout()
    with_approach(copy, *ALONE)
    said = copy.made("results/paper/report.html")
    page = (copy.folder / "results/paper/report.html").read_text(encoding="utf-8")
    assert "with nothing else" in page
    if (size := len(page.encode())) > LARGEST_PAGE:
        assert f"results/paper/report.html has {size:,} bytes, more than the" in said


def test_a_study_can_ask_for_it(extended):
    extended.made("results/studies/toy/summary.md")
    folder = extended.folder / "results/studies/toy"
    cases = pd.read_parquet(folder / "cases.parquet")
    assert cases["F_k_relative_error__toy__least_squares"].abs().max() < 1e-6
    assert cases["c_4_N_s4_per_m4__toy__least_squares"].abs().max() < 1e-3
    # there is none to be off from
    assert "c_4_relative_error__toy__least_squares" not in cases
    assert "with a toy" in (folder / "figure.svg").read_text(encoding="utf-8")
    assert "toy" in (folder / "summary.md").read_text(encoding="utf-8")


def dampbalance(extended, *commands):
    """What commands say, one after the other, in one process of the extended package."""
    run = "import json, sys; from dampbalance.commands.main import main; sys.exit(any(map(main, json.load(sys.stdin))))"
    command, folder = (sys.executable, "-c", run), extended.folder
    given = json.dumps(commands)
    return output_of(*command, folder=folder, given=given, PYTHONPATH=str(folder / "src"))


def test_records_of_such_a_law_are_simulated_and_it_is_found_in_them(extended):
    levels = {"law0.csv": "0.004", "law1.csv": "0.008", "law2.csv": "0.012"}
    options = ["--frequency", "4.92", "--cycles", "20", "--noise", "0.001", "--law", "c_4=20000"]
    dampbalance(
        extended,
        *(["simulate", record, "--amplitude", Y, *options] for record, Y in levels.items()),
    )
    options = ["--stiffness", "2310", "--terms", "F_k,c_4", "--json", "-"]
    found = json.loads(dampbalance(extended, ["identify", *levels, *options]))
    low, high = found["approaches"]["direct"]["c_4_interval_N_s4_per_m4"]
    # the interval holds it in 95 of 100 cases: three times as wide in all but one of 10⁸
    assert abs(0.5 * (low + high) - 20000.0) < 1.5 * (high - low)
    assert high - low < 400.0


def test_an_approach_that_is_not_there_is_named(extended):
    wrong = STUDY | {"estimation": {"approaches": ["toi"]}}
    file = extended.folder / "config/studies/wrong.yaml"
    with restored(file):
        file.write_text(yaml.safe_dump(wrong, allow_unicode=True), encoding="utf-8")
        said = extended.refused("--dry-run", "results/studies/wrong/summary.md")
    assert "'toi' is not an approach (did you mean toy?)" in said
