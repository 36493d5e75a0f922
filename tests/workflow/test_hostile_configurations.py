"""A configuration, however odd, is refused in one line or gives sound results; nothing else happens.

Whole systems are drawn at the border of what is accepted; single values far out are refused in tests/project. What is
accepted goes through the scripts of the workflow, in this process.
"""

from __future__ import annotations

import copy
import json
import math
import random
import warnings

import numpy as np
import pandas as pd
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st

from dampbalance.motion.orbit import RANGES
from dampbalance.project.case import Case, check_case
from dampbalance.project.documents import ConfigurationError
from dampbalance.project.files import read_csv
from dampbalance.replication.feasibility import check_feasible
from folders import ROOT
from workflow.jobs import case_jobs

FILE = ROOT / "config/config.yaml"
PAPER = yaml.safe_load(FILE.read_text(encoding="utf-8"))
LONGEST = 300  # characters of a line
DECIMALS = ["X_decimals", "X_s_decimals", "V_s_decimals", "phi_decimals", "common_phi_decimals"]
NAMES = [
    *("../x", "a/b", "/tmp/x", ".hidden", "-x", "x\n", "", "studies", "archive", "a" * 5000, "a.b"),
    *("con:", "a b", "ω", "<script>alert(1)</script>", "a|b", "$x$", "a\\b", "`ls`"),
]


def log_uniform(draw: random.Random, low: float, high: float) -> float:
    return float(f"{10 ** draw.uniform(math.log10(low), math.log10(high)):.6g}")


def base() -> dict:
    config = copy.deepcopy(PAPER)
    config |= {"case": "hostile", "published": None}
    config["excitation"]["frequencies"] = [{"name": "f", "hz": 4.92}]
    config["as_published"] |= {"step_s": 1e-4, "cycles": 3}
    return config


def at_the_border(draw: random.Random) -> dict:
    """A system anywhere in what is accepted, or a little beyond, with numerics to match."""
    config, pick = base(), draw.choice
    zeta, r, K, F = (log_uniform(draw, *ends) for ends in RANGES.values())
    if draw.random() < 0.7:  # where something slips, and a stick phase is not all too short
        zeta, r = log_uniform(draw, 1e-3, 1.0), log_uniform(draw, 0.3, 4.0)
        K, F = log_uniform(draw, 1.0, 1e4), log_uniform(draw, 1e-2, 1.0)
    m, k, Y = (log_uniform(draw, *ends) for ends in ((1e-4, 1e4), (1.0, 1e8), (1e-6, 1.0)))
    config["oscillator"] = {"m_kg": m, "k_N_per_m": k, "K_z_N_per_m": K * k, "F_k_N": F * k * Y}
    config["oscillator"]["c_N_s_per_m"] = 2.0 * zeta * math.sqrt(k * m)
    hz = r * math.sqrt(k / m) / (2.0 * math.pi)
    levels = pick([[1, 1.5, 2, 3], [1, 1 + 1e-5], [3, 1], [1e-3, 1, 10]])
    drives = [{"name": "f", "hz": hz}]
    config["excitation"] = {"frequencies": drives, "levels_m": [Y * q for q in levels]}
    phase = pick(["reversal", "zero_crossing", "fundamental"])
    config["estimation"] = {"pairs": pick([[[1, 2]], [[2, 1], [1, 2]]]), "phase": phase}
    rules = {key: pick([0, 3, 9, 15, None]) for key in DECIMALS}
    rules |= {"t_s_unit_s": pick([1e-12, 1e-4, 1.0, None])}
    config["as_published"] |= {
        "scheme": pick(["backward-euler", "trapezoidal", "rk4", "explicit-euler"]),
        "step_s": 1.0 / (hz * log_uniform(draw, 300.0, 3e4)),
        "cycles": pick([3, 4, 10]),
        "c_over_m_decimals": pick([0, 2, None, 15]),
        "slip_samples": pick([[], [0], [100] * 4]),
        **{"tabulated": rules, "two_point": rules},
    }
    return config


def assert_sound(folder) -> None:
    """Numbers are numbers or missing with a reason, and exact features balance with the true F_k and c."""
    for file in folder.rglob("*.csv"):
        numbers = pd.read_csv(file).select_dtypes("number").to_numpy()
        assert not np.any(np.isinf(numbers)), file
    (orbits,) = folder.glob("orbits/*.json")
    osc = json.loads(orbits.read_text(encoding="utf-8"))[0]["oscillator"]
    exact = pd.read_csv(folder / "features/exact/f.csv")
    slips = exact[exact["X_s_m"].notna()]
    spent = slips["a_m"] * osc["F_k"] + slips["b_m2_per_s"] * osc["c"]
    # what `check_feasible` lets rounding take, and the last of the 15 digits of a CSV
    np.testing.assert_allclose(slips["W_J"], spent, rtol=1.1e-6)
    estimates = pd.read_csv(folder / "estimates/exact/f.csv")
    missing = estimates[estimates["F_k_N"].isna() & (estimates["kind"] == "least_squares")]
    assert missing["note"].notna().all()


def refused(config: dict, file) -> str:
    """What is said against a configuration, as the workflow looks at it; "" if it is accepted."""
    try:
        check_case(config, [file])
        check_feasible(Case.from_config(config), [file])
    except ConfigurationError as error:
        return str(error)
    return ""


def outcome(config: dict, folder) -> str:
    """Whether it is refused, or sound; anything else is an error of this test."""
    file = folder / "case.yaml"
    file.write_text(yaml.safe_dump(config, allow_unicode=True), encoding="utf-8")
    if refusal := refused(config, file):
        for line in refusal.splitlines():
            assert line.startswith((str(file), "…"))
            assert len(line) <= LONGEST
        assert list(folder.iterdir()) == [file]
        return "refused"
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # X rounded to zero, say, divides: NaN
        case_jobs(config, folder / "results")
    assert {path.name for path in folder.iterdir()} == {"case.yaml", "results"}
    assert_sound(folder / "results")
    return "sound"


def test_a_configuration_is_refused_or_gives_sound_results(tmp_path):
    answers = []
    for seed in range(8):
        folder = tmp_path / f"{seed}"
        folder.mkdir()
        answers.append(outcome(at_the_border(random.Random(seed)), folder))
    assert {*answers} == {"refused", "sound"}


@settings(max_examples=80)
@given(draw=st.randoms())
def test_many_configurations_are_refused_or_give_sound_results(tmp_path_factory, draw):
    outcome(at_the_border(draw), tmp_path_factory.mktemp("case"))


def test_frequencies_may_be_called_like_numbers_and_like_no_value(tmp_path):
    names = ["1", "01", "1e3", "nan", "two_point"]
    config = base() | {"case": "nan"}
    drives = [{"name": name, "hz": 3.0 + i} for i, name in enumerate(names)]
    config["excitation"]["frequencies"] = drives
    check_case(config, [FILE])
    case_jobs(config, tmp_path)
    table = read_csv(tmp_path / "tables/approaches.csv")
    assert list(dict.fromkeys(table["frequency"])) == names
    assert (tmp_path / "tables/table1_nan.csv").is_file()


def test_no_name_leaves_the_results(tmp_path):
    file = tmp_path / "case.yaml"
    file.write_text(yaml.safe_dump(base()), encoding="utf-8")
    assert [name for name in NAMES if not refused(base() | {"case": name}, file)] == []
