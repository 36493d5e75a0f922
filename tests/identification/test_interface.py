"""The interface of identification: signatures are the documentation, and each kind refuses the options of others."""

from __future__ import annotations

import inspect
import json
import math
import re
import shutil
import sys

import numpy as np
import pytest

from dampbalance import (
    BaseMotion,
    Oscillator,
    identify,
    identify_decays,
    identify_forced,
    identify_friction_speed,
    identify_joint,
    identify_loops,
    measured_orbit,
    measured_ring_down,
    steady_orbit,
    steady_orbits,
)
from dampbalance.measured import WAYS
from dampbalance.project.case import read_case_schema
from dampbalance.project.options import IN_WORDS, OPTIONS, configured, contradictions
from dampbalance.records.quantities import with_error
from folders import ROOT
from paper_case import PAPER
from processes import output_of
from rooms import PACKAGE

K = 2310.0
TABLE = str(ROOT / "config/records/stepped/levels.csv")
SOFT = Oscillator(m=2.42, c=1.0, k=K, K_z=20800.0, F_k=0.5)
DECAY = measured_ring_down(SOFT, x=0.01, rate_hz=500.0, duration=2.0, noise=0.001)
FORCED = [
    measured_orbit(
        steady_orbit(PAPER, BaseMotion(Y, 7.0 * math.pi)),
        rate_hz=500.0,
        cycles=20.0,
        noise=0.01,
        seed=i,
    )
    for i, Y in enumerate((0.004, 0.008, 0.012))
]
_T = np.arange(0.0, 8.0, 0.01)
LOOPS = {
    "time_s": _T,
    "displacement_mm": np.cos(2.0 * math.pi * _T),
    "force_N": np.clip(9.0 * np.cos(2.0 * math.pi * _T - 0.3), -5.0, 5.0),
}
SPEEDS = {"speed_rpm": [1, -1, 2, -2, 4, -4, 8, -8], "torque_N_m": [3, -3, 4, -4, 5, -5, 9, -9]}
RECORDS = {"forced": FORCED, "ring-down": DECAY, "stepped-sine": TABLE, "loops": LOOPS}
RECORDS |= {"friction-speed": SPEEDS}
# a value of each option that is not its default
VALUES = {
    "frequency": 3.5,
    "terms": "F_k,c",
    "given": {"c": 90.0},
    "groups": {"F_k": "A,A,B"},
    "laws": True,
    "skip_cycles": 1,
    "contact": "gradual",
    "hardening": False,
    "residual": True,
    "normal_force": 5.0,
    "fixture_stiffness": 1e6,
    "backlash": False,
}
MISPLACED = [
    (kind, name) for kind in IN_WORDS for name in VALUES if kind not in OPTIONS[name].kinds
]


@pytest.mark.parametrize(("kind", "name"), MISPLACED)
@pytest.mark.parametrize("stated", [False, True], ids=["recognised", "stated"])
def test_an_option_of_another_kind_is_refused_in_one_sentence(kind, name, stated):
    options = {name: VALUES[name]} | ({"kind": kind} if stated else {})
    with pytest.raises(
        ValueError, match=f"^{name} = .* is for .*, and these are .*: leave it out$"
    ):
        identify(RECORDS[kind], K if kind in OPTIONS["stiffness"].kinds else None, **options)


@pytest.mark.parametrize(("kind", "name"), MISPLACED)
def test_a_configuration_is_refused_for_the_same_options(kind, name):
    key = OPTIONS[name].key
    k = {"stiffness_N_per_m": K} if kind in OPTIONS["stiffness"].kinds else {}
    wrong = dict(contradictions({"kind": kind, **k, key: VALUES[name]}))
    assert [*wrong] == [key]
    assert re.fullmatch("is for .*, and these are .*: leave it out", wrong[key])


def test_only_records_in_time_of_an_oscillator_need_a_stiffness():
    for kind in WAYS:
        lacks = dict(contradictions({"kind": kind}))
        assert [*lacks] == (["stiffness_N_per_m"] if kind in ("forced", "ring-down") else [])


def test_a_stiffness_may_be_text_as_a_mass_may():
    assert with_error("k", "2310") == with_error("k", 2310.0) == (2310.0, 0.0)
    assert with_error("k", "2310±10") == (2310.0, 10.0)


def test_an_unknown_option_is_that_of_a_call():
    with pytest.raises(TypeError, match="unexpected keyword argument 'frequncy'"):
        identify(FORCED, K, frequncy=3.5)


def test_an_option_at_its_default_may_be_given_for_any_kind():
    named = {name: OPTIONS[name].default for name in VALUES}
    assert identify(DECAY, K, **named).values == identify_decays(DECAY, K).values


@pytest.mark.parametrize(
    ("kind", "options"),
    [
        ("forced", {"frequency": 3.5, "mass": "2.42"}),
        ("ring-down", {"mass": "2.42"}),
        ("stepped-sine", {"contact": "one slider"}),
        ("loops", {"backlash": False}),
        ("friction-speed", {}),
    ],
)
def test_it_hands_over_to_the_function_of_the_kind(kind, options):
    options |= {"stiffness": (K, 10.0)} if kind in ("forced", "ring-down") else {}
    own = WAYS[kind](RECORDS[kind], **options)
    assert own is not identify(RECORDS[kind], **options)
    for stated in ("recognised", kind):
        found = identify(RECORDS[kind], kind=stated, **options)
        assert found.document() == own.document()


@pytest.mark.parametrize(
    "function",
    [
        identify,
        identify_decays,
        identify_forced,
        identify_friction_speed,
        identify_joint,
        identify_loops,
    ],
)
def test_the_docstring_has_every_argument_of_the_signature(function):
    words = inspect.getdoc(function)
    for name in inspect.signature(function).parameters:
        assert re.search(rf"^(\w+, )*{name}(, \w+)* : ", words, re.MULTILINE), name


def test_the_keys_of_a_configuration_are_the_arguments():
    keys = read_case_schema()["properties"]["measured"]["items"]["properties"].keys()
    stated = dict.fromkeys(keys, 1.0) | {"kind": "forced"}
    arguments = configured(stated).keys()
    assert {"records", *arguments} == inspect.signature(identify).parameters.keys()
    assert identify.__kwdefaults__["kind"] == "recognised"


TOY = """
import inspect, json
from dampbalance import identify, identify_decays, identify_forced
from dampbalance.commands.main import parser
from dampbalance.identification.request import read_options
from dampbalance.project.case import read_case_schema
from dampbalance.project.options import configured, contradictions

def refused(**options):
    try:
        identify_decays([], 2310.0, **options)
    except ValueError as error:
        return str(error)

signatures = {f.__name__: f for f in (identify, identify_forced, identify_decays)}
argued = parser(["identify"]).parse_args(["identify", "a.csv", "--toy", "3 mm"]).toy
print(json.dumps({
    "signatures": [n for n, f in signatures.items() if "toy" in inspect.signature(f).parameters],
    "help": [n for n, f in signatures.items() if "toy : m, how much of a toy." in f.__doc__],
    "argued": argued,
    "usage": parser(["identify"])._subparsers._group_actions[0].choices["identify"].format_help(),
    "schema": read_case_schema()["properties"]["measured"]["items"]["properties"]["toy_m"],
    "configured": configured({"toy_m": 2.0}),
    "refused": refused(toy="2 mm"),
    "key": dict(contradictions({"kind": "ring-down", "mass_kg": 1.0, "toy_m": 2.0})),
    "options": read_options("forced", {"stiffness": 2310.0, "toy": argued})["toy_m"],
}))
"""
ROW = '    toy: Annotated[float | str | None, Option("how much of a toy", bounds=NUMBERS["Y"])]\n'


def test_an_option_is_one_row_of_the_table(tmp_path):
    """A copy of the package with one line more, which stands in nothing else that knows an option."""
    package = shutil.copytree(
        PACKAGE, tmp_path / "dampbalance", ignore=shutil.ignore_patterns("__pycache__")
    )
    table = package / "project/options.py"
    head, rows, rest = table.read_text("utf-8").partition(
        "class _OfForced(TypedDict, total=False):\n"
    )
    table.write_text(head + rows + ROW + rest, encoding="utf-8")
    told = json.loads(output_of(sys.executable, "-c", TOY, folder=tmp_path))
    assert told["signatures"] == told["help"] == ["identify", "identify_forced"]
    assert re.search(r"\nforced records:\n(.*\n)*  --toy m +how much of a toy\n", told["usage"])
    assert told["schema"]["minimum"] == 1e-30
    assert "positive number of m" in told["schema"]["description"]
    assert told["configured"] == {"kind": "forced", "toy": 2.0}
    wrong = "is for forced records, and these are free decays: leave it out"
    assert told["refused"] == f"toy = 2 mm {wrong}"
    assert told["key"] == {"toy_m": wrong}
    assert told["options"] == 0.003


def test_mass_frequency_and_damping_ratio_are_those_of_the_oscillator():
    found = identify_decays(DECAY, K)
    assert found.mass == pytest.approx(2.42, rel=1e-3)  # noise of 0.1 %
    assert found.natural_frequency == pytest.approx(math.sqrt(K / 2.42) / (2 * math.pi), rel=1e-3)
    assert found.damping_ratio == pytest.approx(1.0 / (2 * math.sqrt(K * 2.42)), rel=0.1)
    document = found.document()
    assert document["damping"]["damping_ratio"] == pytest.approx(found.damping_ratio, rel=1e-12)
    fit = document["maximum_likelihood"]
    assert fit["m_kg"] == pytest.approx(found.mass, rel=1e-12)
    assert fit["natural_frequency_Hz"] == pytest.approx(found.natural_frequency, rel=1e-12)


def test_what_no_fit_determines_is_nan():
    still = [  # nothing slips: a linear oscillator, whose mass no fit of a slider determines
        measured_orbit(
            steady_orbit(stuck, BaseMotion(Y, 8.0 * math.pi)), rate_hz=500.0, cycles=20.0
        )
        for stuck in [Oscillator(2.42, 90.0, K, 208000.0, 0.0)]
        for Y in (0.002, 0.004)
    ]
    found = identify_forced(still, K)
    assert found.values["c"] == pytest.approx(90.0, rel=1e-6)
    assert all(map(math.isnan, (found.mass, found.natural_frequency, found.damping_ratio)))


def test_an_oscillator_stands_for_its_numbers_in_steady_orbits():
    numbers = {name: getattr(PAPER, name) for name in ("m", "c", "k", "K_z", "F_k")}
    Y, omega = [0.004, 0.008], 22.0
    of = steady_orbits(PAPER, Y=Y, omega=omega)
    np.testing.assert_array_equal(of.X, steady_orbits(**numbers, Y=Y, omega=omega).X)
    assert of.X[0] == steady_orbit(PAPER, BaseMotion(0.004, omega)).X
    softer = steady_orbits(PAPER, K_z=[208000.0, 2080.0], Y=0.004, omega=omega)
    one = Oscillator(**numbers | {"K_z": 2080.0})
    assert softer.X[1] == steady_orbit(one, BaseMotion(0.004, omega)).X
    assert softer.varied == ("K_z",)
    with pytest.raises(ValueError, match="oscillator must be an Oscillator, got 5"):
        steady_orbits(5, Y=Y, omega=omega)
    with pytest.raises(ValueError, match=r"m must be a positive number of kg, .*got None"):
        steady_orbits(Y=Y, omega=omega)
