"""The instruments on the printed numbers: they show what Python gives."""

from __future__ import annotations

import json
import random
import re
from dataclasses import replace

import pytest

from dampbalance.project.case import Case
from dampbalance.publishing.page.instruments import of_run
from dampbalance.replication.authors_route import scheme_table
from dampbalance.replication.claims.changed_digits import (
    cells,
    judged,
    other_digits,
    verdicts_of_changes,
)
from dampbalance.replication.claims.judging import explanation, verdict
from dampbalance.replication.claims.verdicts import VERDICTS
from folders import ROOT
from publishing.page_case import CHANGED
from publishing.test_instruments import GO, checked, plain, printed, texts
from replication.routes import CASE, PRINT, sources_of
from replication.routes import judged as judged_afresh

INTEGRATOR = """() => [...document.querySelectorAll('#integrator td')].map(cell => [
  cell.classList[1], cell.querySelector('.digits').textContent, cell.querySelector('small').textContent])"""


@pytest.fixture
def opened(visit, report):
    """Leads to a state of an instrument and waits until it has computed, on a page that tests share: an address states
    all of it."""

    def page(name, state=""):
        view = visit.again((report / "report.html").as_uri(), reduced_motion="reduce")
        view.wait_for_selector(f"#{name}.ready", state="attached")
        view.evaluate(GO, f"{name}?{state}")
        view.wait_for_selector(f"#{name}.ready:not(.busy)")
        view.wait_for_function(f"() => document.querySelector('#{name} .words').textContent")
        view.wait_for_selector(f"#{name}.ready:not(.busy)")
        return view

    yield page
    assert visit.said == []


@pytest.mark.slow
def test_the_recipe_agrees_with_print_as_the_claims_say(opened, made):
    page = opened("integrator")
    assert "0 of them in every digit" in page.inner_text(
        "#integrator .words"
    )  # opens at a wrong guess
    page = opened("integrator", "scheme=backward-euler&step=5&coefficients=rounded")
    claims = {
        row["printed"]: row for row in made.claims.to_dict("records") if row["id"][:6] == "table2"
    }
    got = page.evaluate(INTEGRATOR)
    assert len(got) == 25
    for close, text, off in got:
        units = float(claims[text]["off_units"])
        expected = "all" if abs(units) <= 0.5 else "near" if abs(units) < 10.0 else "off"
        assert close == expected, text
        # shown with a tenth of a unit or three digits; the claims keep two decimals
        assert float(off.replace("−", "-")) == pytest.approx(units, rel=0.01, abs=0.06)
    closes = [close for close, *_ in got]
    near = closes.count("all") + closes.count("near")
    words = page.inner_text("#integrator .words")
    assert f"{near} of 25" in words
    assert f"{closes.count('all')} of them" in words
    held = made.claims[made.claims["verdict"] == "simulated"]["id"].str.startswith("table2.")
    assert closes.count("all") == held.sum()


@pytest.fixture(scope="module")
def schemes():
    return scheme_table(CASE, "omega1")


@pytest.mark.slow
@pytest.mark.parametrize("scheme", ["rk4", "explicit-euler"])
@pytest.mark.parametrize("coefficients", ["rounded", "exact"])
def test_other_schemes_miss_print_as_in_python(opened, schemes, scheme, coefficients):
    page = opened("integrator", f"scheme={scheme}&step=5&coefficients={coefficients}")
    table = schemes.query("scheme == @scheme and coefficients == @coefficients")
    got = {text: off for _, text, off in page.evaluate(INTEGRATOR)}
    for symbol, column in (("a", "a_m"), ("b", "b_m2_per_s"), ("W", "W_J")):
        for level, value in zip(table["level"], table[column], strict=True):
            number = PRINT[f"table2.{symbol}.{level}"]
            units = (value - number.value) / number.unit
            off = got[number.text].replace("−", "-").replace("·10", "e")
            off = off.translate(str.maketrans("⁰¹²³⁴⁵⁶⁷⁸⁹", "0123456789"))
            assert float(off) == pytest.approx(units, rel=0.05, abs=0.06)  # two digits are shown


@pytest.mark.slow
def test_the_program_and_the_configuration_of_the_integrator_compute_the_same(
    opened, tmp_path, monkeypatch
):
    page = opened("integrator", "scheme=backward-euler&step=10&cycles=20")
    program, configuration = texts(page, "integrator")
    monkeypatch.chdir(ROOT)
    a, _, W, (c,) = printed(program)
    assert f"c = {c:.4f};" in plain(page.inner_text("#integrator .words"))
    got = {text: off for _, text, off in page.evaluate(INTEGRATOR)}
    for symbol, values in (("a", a), ("W", W)):
        number = PRINT[f"table2.{symbol}.5"]
        off = re.sub(r"·10⁴", "e4", got[number.text].replace("−", "-"))
        assert float(off) == pytest.approx((values[4] - number.value) / number.unit, rel=0.05)
    numerics = Case.from_config(checked(tmp_path / "shown.yaml", configuration)).numerics
    assert (numerics.step_s, numerics.cycles, numerics.c_over_m_decimals) == (1e-5, 20, None)


def test_misprints_are_judged_as_a_fresh_run_judges_them():
    """Drawn at random from all changes of a digit by one."""
    draw, was = random.Random(27), verdicts_of_changes(sources_of())
    every = [(name, text) for name in cells(sources_of()) for text in other_digits(PRINT[name])]
    assert len(every) == len(set(every)) > 700
    drawn = [
        pick
        for part in ("table1", "table2", "table3")
        for pick in draw.sample([one for one in every if one[0].startswith(part)], 4)
    ]
    for name, text in drawn:
        afresh = judged_afresh(PRINT.changed({name: text})).set_index("id")
        now = {i: verdict(claim).name for i, claim in judged(sources_of(), name, text).items()}
        computed = afresh[afresh["kind"] == "computed"]["verdict"].to_dict()
        assert was | now == computed, (name, text)
        rest = afresh[afresh["kind"] != "computed"]["verdict"].to_dict()
        assert rest == judged_afresh().set_index("id")["verdict"].loc[list(rest)].to_dict()


def unpacked(record, name):
    """The changes of a number as a record tells them: text → its verdict, reason and the others with theirs."""
    _, changes = record["numbers"][name]
    return {
        text: (
            record["verdicts"][own],
            (record["reasons"][reason], numbers),
            [
                (i, record["verdicts"][now], record["because"][why])
                for i, now, why in record["sets"][others]
            ],
        )
        for text, own, reason, numbers, others in changes
    }


def test_the_misprints_on_record_are_those_of_this_run(made):
    record = json.loads((ROOT / "paper/published/misprints.json").read_text(encoding="utf-8"))
    assert set(record["numbers"]) == set(cells(sources_of()))
    assert of_run(record, made.claims)
    for name in CHANGED:
        assert unpacked(record, name) == unpacked(made.digits, name)
    other = made.claims.copy()
    other.loc[other["id"] == CHANGED[0], "printed"] += "1"
    assert not of_run(record, other)
    worse = made.claims.assign(verdict=made.claims["verdict"].replace("simulated", "differs"))
    assert not of_run(record, worse)


@pytest.mark.slow
@pytest.mark.parametrize("name", CHANGED)
def test_the_page_shows_which_verdicts_change(opened, name):
    page, was = opened("misprint", f"number={name}"), verdicts_of_changes(sources_of())
    assert PRINT[name].text in page.inner_text("#misprint .words")
    assert page.locator("#misprint .digit button").count() == 2 * PRINT[name].significant
    ranks = list(VERDICTS)
    for text in other_digits(PRINT[name])[:3]:
        page.click(f'#misprint button[name="to"][value="{text}"]')
        page.wait_for_selector(f'#misprint button[name="to"][value="{text}"][aria-pressed=true]')
        claims = judged(sources_of(), name, text)
        now = {i: verdict(claim).name for i, claim in claims.items()}
        changed = {i: of for i, of in now.items() if of != was[i]}
        rows = page.locator("#misprint .noticed tr").all_inner_texts()
        assert len(rows) == len(changed)
        for row, i in zip(rows, sorted(changed, key=lambda one: one != name), strict=True):
            assert now[i] in row
            assert was[i] in row
        worse = sum(ranks.index(of) > ranks.index(was[i]) for i, of in changed.items())
        words = page.inner_text("#misprint .words")
        assert (f"{worse} verdict" if worse else "nobody would notice") in words
        if name in changed:
            assert explanation(replace(claims[name], cause="")) in rows[0]


@pytest.mark.slow
def test_the_program_of_a_misprint_judges_it(opened, monkeypatch, capsys):
    name, text = "table2.c.2-3", "90.0115"
    page = opened("misprint", f"number={name}&to={text}")
    program, _ = texts(page, "misprint")
    monkeypatch.setattr(
        "dampbalance.replication.claims.rules.read_sources", lambda *_: sources_of()
    )
    monkeypatch.chdir(ROOT)
    exec(compile(program, "shown", "exec"), {})
    said = capsys.readouterr().out.splitlines()
    assert len(said) == page.locator("#misprint .noticed tr").count()
    assert any(line.startswith(f"{name} simulated -> differs") for line in said)
