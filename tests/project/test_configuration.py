"""Every mistake in a configuration gets one line that names file, key and remedy."""

from __future__ import annotations

import copy
import math
import re
from dataclasses import replace

import pytest
import yaml

from dampbalance.model import Oscillator
from dampbalance.project.case import Case, check_case, excerpt, require_own_case
from dampbalance.project.documents import ConfigurationError
from folders import ROOT
from schemas import SCHEMAS, schema_of, values

FILE = ROOT / "config/config.yaml"


@pytest.fixture
def config():
    return yaml.safe_load(FILE.read_text(encoding="utf-8"))


def problem(config, files=(FILE,)):
    with pytest.raises(ConfigurationError) as caught:
        check_case(config, files)
    return str(caught.value)


def edited(config, key, value):
    changed = copy.deepcopy(config)
    *above, last = [int(part) if part.isdigit() else part for part in key.split(".")]
    section = changed
    for part in above:
        section = section[part]
    section[last] = value
    return changed


SET = {"name": "set", "records": ["a.csv"], "stiffness_N_per_m": 1.0}
WRONG = [
    ("oscillator.m_kg", -2.42, "line 6: oscillator.m_kg: -2.42 is not allowed. Mass m, kg; pos"),
    ("oscillator.k_N_per_m", "2310", "k_N_per_m: '2310' is text to YAML; write it without quotes"),
    ("as_published.step_s", "5e-6", "as_published.step_s: '5e-6' is text to YAML; write 5.0e-6"),
    ("oscillator.m_g", 2.0, "oscillator.m_g: unknown key (did you mean m_kg?); known here: m_kg"),
    ("oscillator.F_k_N", math.nan, "oscillator.F_k_N: nan is not a finite number"),
    ("as_published.cycles", 20.0, "as_published.cycles: 20.0 is not allowed"),
    ("excitation.levels_m", [4e-3, 6e-3, 8e-3, 0.01, 4.00000001e-3], "is the same as level 1 to"),
    ("excitation.frequencies.0.name", "a/b", "frequencies[1].name: 'a/b' cannot be a name"),
    ("excitation.frequencies.0.name", "OMEGA2", "frequencies[2].name: omega2 stands twice"),
    ("as_published.tabulated.X_s_mark_m", 1e-6, "X_s_mark_m: not together with X_s_decimals"),
    ("estimation.pairs", [[1, 6]], "estimation.pairs[1]: there is no level 6: excitation.levels_m"),
    ("estimation.pairs", [[2, 2]], "estimation.pairs[1]: [2, 2] is not allowed"),
    ("measured", [SET | {"stiffness_N_per_m": 1e300}], "[1].stiffness_N_per_m: 1e+300 is not"),
    ("measured", [SET | {"given": {"c": 1e300}}], "measured[1].given.c"),
]


@pytest.mark.parametrize(("key", "value", "said"), WRONG)
def test_a_wrong_value_is_named_with_its_file_and_remedy(config, key, value, said):
    (line,) = problem(edited(config, key, value)).splitlines()
    assert line.startswith(f"{FILE}: ")
    assert said in line


def test_all_problems_are_listed_each_with_the_file_that_sets_its_key(config, tmp_path):
    check_case(config, [FILE])
    override = tmp_path / "mine.yaml"
    override.write_text("oscillator: {m_kg: -1}\n", encoding="utf-8")
    del config["oscillator"]["F_k_N"]
    wrong = edited(edited(config, "oscillator.m_kg", -1), "oscillator.c_N_s_per_m", -1)
    lines = problem(wrong, [FILE, override]).splitlines()
    assert len(lines) == 3
    assert lines[0].startswith(f"{FILE}: line 10: oscillator.F_k_N: missing; Friction force")
    assert lines[1].startswith(f"{FILE}: line 7: oscillator.c_N_s_per_m: -1 is not allowed")
    assert lines[2].startswith(f"{override}: line 1: oscillator.m_kg: -1 is not allowed")


def test_every_key_is_described_and_no_other_taken():
    def walk(node, name):
        for key, child in node.get("properties", {}).items():
            assert child.get("description") or name.startswith("study"), f"{name}.{key}"
            walk(child, f"{name}.{key}")
        assert not node.get("properties") or node["additionalProperties"] is False, name

    for name in SCHEMAS:
        walk(schema_of(name), name)


# Beside these, what a study sets and draws is bounded in `studies.parameters`, and positions by what there is.
UNBOUNDED = r"""study: (base|axes|read_out|figure\.(marks|at)|estimation\.fits|levels).*
study: route\.(step_s|steps_per_cycle|sampling_hz|noise)
config: (estimation\.pairs|measured\[\]\.groups).*
mapping: level"""


def test_every_number_has_bounds():
    """1e300 is finite, and no factorisation survives it: each key says how far numbers may go."""
    for key, node in values({"number", "integer"}):
        bounded = {"minimum", "exclusiveMinimum"} & node.keys() and "maximum" in node
        assert bounded or any(re.fullmatch(one, key) for one in UNBOUNDED.split("\n")), key


def test_the_case_is_in_si_units_and_an_excerpt_makes_the_fields_it_names(config):
    case = Case.from_config(config)
    assert (case.name, case.phase) == ("paper", "reversal")
    assert case.oscillator == Oscillator(m=2.42, c=90.0, k=2310.0, K_z=208000.0, F_k=1.28)
    assert case.pairs[0] == (0, 1)
    assert (case.numerics.scheme, case.numerics.step_s) == ("backward-euler", 5e-6)
    assert replace(case.numerics, slip_samples=(2, 3)).after_slip(1) == 3
    assert case.numerics.after_slip(99) == 1
    assert [m.Y for m in case.motions("omega1")] == [0.004, 0.006, 0.008, 0.010, 0.012]
    assert case.motions("omega3")[0].omega == 2.0 * math.pi * 11.1
    assert [case.suffix(name) for name in case.frequencies_hz] == ["", "_omega2", "_omega3"]
    fields = ("oscillator", "levels_m", "frequencies_hz", "pairs", "phase", "numerics", "name")
    assert Case.from_config(excerpt(config, *fields)) == case
    for field in fields:
        only = excerpt(config, field)
        assert Case.from_config(only) == Case(**{field: getattr(case, field)})
        key = next(iter(only))
        assert only[key] == config[key] or set(only[key]) < set(config[key])


@pytest.mark.parametrize(
    ("name", "case"),
    [("more friction", "more_friction"), ("paper", "my_paper"), ("Ü", "my_case")],
)
def test_an_override_without_a_case_is_refused_with_a_name_that_works(config, tmp_path, name, case):
    override, named = tmp_path / f"{name}.yaml", tmp_path / "named.yaml"
    override.write_text("oscillator: {F_k_N: 1.5}\n", encoding="utf-8")
    named.write_text("case: mine\n", encoding="utf-8")
    require_own_case([])
    require_own_case([named, override])
    with pytest.raises(ConfigurationError) as refused:
        require_own_case([override])
    (said,) = str(refused.value).splitlines()
    assert f"{name}.yaml: case: is missing" in said
    wanted = re.search(r"\((case: .+?)\), and add (published: null)", said)
    remedy = yaml.safe_load(f"{wanted[1]}\n{wanted[2]}\n")
    assert remedy == {"case": case, "published": None}
    check_case(config | remedy, [])
