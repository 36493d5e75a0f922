"""Every mistake in a configuration gets one line that names file, key and remedy."""

from __future__ import annotations

import copy
import math
import re

import pytest
import yaml

from dampbalance.model import Oscillator
from dampbalance.project.case import Case, check_case, excerpt, require_own_case
from dampbalance.project.documents import ConfigurationError
from folders import ROOT
from schemas import schema_of, values

FILE = ROOT / "config/config.yaml"
NAME = ("excitation", "frequencies", 0, "name")


@pytest.fixture
def config():
    return yaml.safe_load(FILE.read_text(encoding="utf-8"))


def problem(config, files=(FILE,)):
    with pytest.raises(ConfigurationError) as caught:
        check_case(config, files)
    return str(caught.value)


def edited(config, key, value):
    changed = copy.deepcopy(config)
    section = changed
    for part in key[:-1]:
        section = section[part]
    section[key[-1]] = value
    return changed


def test_the_shipped_configuration_passes(config):
    check_case(config, [FILE])


@pytest.mark.parametrize(
    ("key", "value", "expected"),
    [
        (("oscillator", "m_kg"), -2.42, ["oscillator.m_kg", "-2.42", "Mass m, kg; positive"]),
        (("oscillator", "m_kg"), 0, ["oscillator.m_kg", "positive"]),
        (("oscillator", "c_N_s_per_m"), True, ["oscillator.c_N_s_per_m", "N s/m"]),
        (("oscillator", "k_N_per_m"), "2310", ["oscillator.k_N_per_m", "without quotes"]),
        (("oscillator", "mass"), 2.0, ["oscillator.mass", "unknown key", "m_kg"]),
        (("oscillator", "m_g"), 2.0, ["oscillator.m_g", "did you mean m_kg?"]),
        (("oscillator", "F_k_N"), math.nan, ["oscillator.F_k_N", "finite"]),
        (("oscillator", "K_z_N_per_m"), math.inf, ["oscillator.K_z_N_per_m", "finite"]),
        (("as_published", "step_s"), "5e-6", ["as_published.step_s", "text", "5.0e-6"]),
        (("as_published", "scheme"), "euler", ["as_published.scheme", "Integration scheme"]),
        (("as_published", "cycles"), 0, ["as_published.cycles", "read"]),
        (("excitation", "levels_m"), [], ["excitation.levels_m", "at least two"]),
        (("excitation", "levels_m"), [0.004], ["excitation.levels_m", "cannot tell F_k from c"]),
        (("excitation", "levels_m"), [0.004, 0.01, 0.004], ["levels_m", "all different"]),
        (("excitation", "levels_m"), [0.004, 0.0], ["excitation.levels_m[2]", "positive"]),
        (("excitation", "frequencies"), [], ["excitation.frequencies", "one to 20"]),
        (("excitation", "frequencies", 1, "hz"), 0.0, ["frequencies[2].hz", "0.0", "positive"]),
        (NAME, "a/b", ["frequencies[1].name", "a/b", "letters"]),
        (NAME, "omega2", ["frequencies[2].name", "twice"]),
        (NAME, "OMEGA2", ["frequencies[2].name", "twice"]),
        (NAME, "a" * 60, ["frequencies[1].name", "in a row"]),
        (NAME, "a1-" * 20, ["frequencies[1].name"]),
        (("as_published", "tabulated", "X_s_mark_m"), 1e-6, ["X_s_mark_m", "X_s_decimals"]),
        (("estimation", "pairs"), [[1, 6]], ["estimation.pairs[1]", "no level 6", "has 5"]),
        (("estimation", "pairs"), [[2, 2]], ["estimation.pairs[1]", "[2, 2]", "Two positions"]),
        (("estimation", "pairs"), [], ["estimation.pairs", "Pairs of levels"]),
        (("estimation", "phase"), "lag", ["estimation.phase", "velocity reversal"]),
        (("case",), "my case", ["case", "my case", "Letters, digits"]),
    ],
)
def test_a_wrong_value_is_named_with_its_file_and_remedy(config, key, value, expected):
    message = problem(edited(config, key, value))
    assert str(FILE) in message
    assert len(message.splitlines()) == 1
    for part in expected:
        assert part in message


def test_a_missing_key_is_named_with_its_meaning(config):
    del config["oscillator"]["F_k_N"]
    message = problem(config)
    assert "oscillator.F_k_N: missing" in message
    assert "Friction force F_k in slip, N" in message


def test_all_problems_are_listed_at_once(config):
    changed = edited(edited(config, ("oscillator", "m_kg"), -1.0), ("estimation", "phase"), "x")
    lines = problem(changed).splitlines()
    assert len(lines) == 2
    assert "oscillator.m_kg" in lines[1]
    assert "estimation.phase" in lines[0]


def test_the_file_that_sets_the_key_is_named_when_several_are_merged(config, tmp_path):
    override = tmp_path / "mine.yaml"
    override.write_text("oscillator: {m_kg: -1}\n", encoding="utf-8")
    message = problem(edited(config, ("oscillator", "m_kg"), -1), [FILE, override])
    assert message.startswith(f"{override}: line 1: oscillator.m_kg")
    message = problem(edited(config, ("oscillator", "c_N_s_per_m"), -1), [FILE, override])
    assert message.startswith(f"{FILE}: line 7: oscillator.c_N_s_per_m")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("case: a\noscillator: {}\ncase: b\n", "line 3: .*duplicate key .case."),
        ("case: [a\n", "not readable as YAML"),
    ],
)
def test_a_file_that_cannot_be_read_is_named(config, tmp_path, text, message):
    file = tmp_path / "wrong.yaml"
    file.write_text(text, encoding="utf-8")
    assert re.match(rf"{file}: .*{message}", problem(config, [file]))


@pytest.mark.parametrize("name", ["config", "mapping"])
def test_every_key_is_described(name):
    def walk(node, name):
        for key, child in node.get("properties", {}).items():
            assert child.get("description"), f"{key} has no description in the schema"
            walk(child, key)
        if node.get("properties"):
            assert node["additionalProperties"] is False, f"{name} would take unknown keys"

    walk(schema_of(name), "top level")


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


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("stiffness_N_per_m", 1e300),
        ("stiffness_N_per_m", 1e-300),
        ("mass_kg", 1e300),
        ("frequency_hz", 1e-300),
        ("skip_cycles", 2**62),
        ("given", {"c": 1e300}),
    ],
)
def test_a_number_far_out_in_a_set_is_named(config, key, value):
    one = {"name": "set", "records": ["a.csv"], "stiffness_N_per_m": 1.0, key: value}
    (line,) = problem(config | {"measured": [one]}).splitlines()
    assert f"measured[1].{key}" in line
    assert "is not allowed" in line


def test_the_case_is_in_si_units_and_the_packages_types(config):
    case = Case.from_config(config)
    assert case.name == "paper"
    assert case.oscillator == Oscillator(m=2.42, c=90.0, k=2310.0, K_z=208000.0, F_k=1.28)
    assert case.pairs[0] == (0, 1)
    assert case.phase == "reversal"
    assert (case.numerics.scheme, case.numerics.step_s) == ("backward-euler", 5e-6)
    assert case.numerics.two_point == config["as_published"]["two_point"]
    assert [m.Y for m in case.motions("omega1")] == [0.004, 0.006, 0.008, 0.010, 0.012]
    assert case.motions("omega3")[0].omega == case.omega("omega3") == 2.0 * math.pi * 11.1
    assert [case.suffix(name) for name in case.frequencies_hz] == ["", "_omega2", "_omega3"]


def test_an_excerpt_makes_the_fields_it_names_and_holds_nothing_else(config):
    whole = Case.from_config(config)
    fields = ("oscillator", "levels_m", "frequencies_hz", "pairs", "phase", "numerics", "name")
    assert Case.from_config(excerpt(config, *fields)) == whole
    for field in fields:
        only = excerpt(config, field)
        assert Case.from_config(only) == Case(**{field: getattr(whole, field)})
        key = next(iter(only))
        assert only[key] == config[key] or set(only[key]) < set(config[key])


def test_an_override_that_names_a_case_is_taken(tmp_path):
    one, other = tmp_path / "friction.yaml", tmp_path / "named.yaml"
    one.write_text("oscillator: {F_k_N: 1.5}\n", encoding="utf-8")
    other.write_text("case: mine\n", encoding="utf-8")
    require_own_case([])
    require_own_case([other, one])


@pytest.mark.parametrize(
    ("name", "case"),
    [
        ("friction", "friction"),
        ("more friction", "more_friction"),
        ("paper", "my_paper"),
        ("Ü", "my_case"),
    ],
)
def test_an_override_without_a_case_is_refused_in_a_line_with_a_name_that_works(
    config, tmp_path, name, case
):
    override = tmp_path / f"{name}.yaml"
    override.write_text("oscillator: {F_k_N: 1.5}\n", encoding="utf-8")
    with pytest.raises(ConfigurationError) as refused:
        require_own_case([override])
    said = str(refused.value)
    assert f"{name}.yaml: case: is missing" in said
    assert "\n" not in said
    wanted = re.search(r"\((case: .+?)\), and add (published: null)", said)
    remedy = yaml.safe_load(f"{wanted[1]}\n{wanted[2]}\n")
    assert remedy == {"case": case, "published": None}
    check_case(config | remedy, [])
