"""The benchmarks, with a handful of cases: they run, agree with the exact solutions, and compute ratios right."""

from __future__ import annotations

import subprocess
from importlib.util import find_spec

import numpy as np
import pandas as pd
import pytest

from benchmarks import __main__ as command
from benchmarks import gpu, identification, loops, peer_scipy, peers
from benchmarks.cases import forty_digits, sweep, worst_error
from benchmarks.measuring import Contestant, interleaved, ratios
from benchmarks.shooting import broyden

CASES = sweep(2)


@pytest.fixture(scope="module")
def exact():
    return forty_digits(CASES)


def test_ours_has_eleven_digits(exact):
    assert worst_error(peers.ours(1)(CASES), exact) < 1e-11


# scipy integrates with a relative tolerance of 1e-10 and stops at 1e-10 between half cycles: some units of it are left
@pytest.mark.parametrize("solve", [peer_scipy.shooting, peer_scipy.events_from_guess])
def test_scipy_solves_the_same_problem(solve, exact):
    assert worst_error(solve(CASES), exact) < 1e-8


@pytest.mark.skipif(not find_spec("heyoka"), reason="heyoka is not installed: make peers")
@pytest.mark.parametrize("kind", ["Settling", "SettlingBatch", "Shooting", "ShootingBatch"])
def test_heyoka_solves_the_same_problem(kind, exact):
    from benchmarks import peer_heyoka

    solver = getattr(peer_heyoka, kind)
    solve = solver(from_rest=False) if kind.startswith("Settling") else solver()
    assert worst_error(solve(CASES), exact) < 1e-10  # stops at 1e-12 between half cycles


@pytest.mark.skipif(not find_spec("diffrax"), reason="diffrax is not installed: make peers")
@pytest.mark.parametrize("method", ["from_guess", "shooting"])
def test_diffrax_solves_the_same_problem(method, exact):
    from benchmarks import peer_diffrax

    # tolerance 1e-10, but the event is located on an interpolant of lower order: 7e-9 was seen
    assert worst_error(getattr(peer_diffrax, method)(CASES), exact) < 1e-7


def test_without_a_gpu_the_benchmark_says_why(tmp_path, monkeypatch):
    for installed, words in (
        (None, "numba-cuda is not installed"),
        ("there", "finds no NVIDIA GPU"),
    ):
        monkeypatch.setattr(gpu, "find_spec", lambda name, installed=installed: installed)
        if installed and not gpu.missing():
            pytest.skip("there is a GPU: make bench BENCH_ARGS=gpu")
        gpu.run(tmp_path)
        assert words in (tmp_path / "gpu.md").read_text(encoding="utf-8")


def test_peers_write_what_they_measured(tmp_path, monkeypatch):
    found = {peers.REFERENCE: (64, peers.ours(1)), "scipy, shooting": (1, peer_scipy.shooting)}
    monkeypatch.setattr(peers, "solvers", lambda size: (found, ["a peer"]))
    peers.run(tmp_path, repetitions=2, exact_cases=1)
    summary = pd.read_csv(tmp_path / "peers.csv").set_index("name")
    assert list(summary.index) == list(found)
    assert summary.loc[peers.REFERENCE, "cpu_ratio_median"] == 1.0
    assert summary.loc["scipy, shooting", "wall_ratio_low"] > 10.0
    assert (summary["worst_relative_error"] < 1e-8).all()
    assert "Not installed and left out: a peer." in (tmp_path / "peers.md").read_text("utf-8")
    assert (tmp_path / "peers.svg").stat().st_size > 1000


def test_missing_peers_are_named(monkeypatch):
    monkeypatch.setattr(peers, "find_spec", lambda name: None)
    found, missing = peers.solvers(1.0)
    assert missing == ["heyoka", "diffrax"]
    assert all(name.startswith(("dampbalance", "scipy")) for name in found)


def test_a_ratio_compares_within_a_repetition():
    timings = pd.DataFrame(
        {
            "repetition": [0, 0, 1, 1, 2, 2],
            "name": ["ours", "peer"] * 3,
            "wall_s_per_case": [1.0, 10.0, 2.0, 60.0, 4.0, 80.0],
        }
    )
    found = ratios(timings, "ours", "wall_s_per_case").set_index("name")
    assert found.loc["peer"].tolist() == [10.0, 20.0, 30.0]
    assert found.loc["ours"].tolist() == [1.0, 1.0, 1.0]


def test_contestants_take_turns():
    calls = []
    contestants = [Contestant(name, 1, lambda name=name: calls.append(name)) for name in "ab"]
    assert len(interleaved(contestants, 3)) == 6
    assert calls == ["a", "b"] * 3


IMPORT_TIMES = (
    "import time: self [us] | cumulative | imported package\n"
    "import time:       200 |        300 |   numba.core\n"
    "import time:       700 |       1000 | numba\n"
    "import time:       100 |        100 |   pandas\n"
)


@pytest.mark.slow
def test_identification_writes_what_it_measured(tmp_path, monkeypatch, capsys):
    def here(script, arguments, *options):
        """In this process, where all is imported: a new one takes seconds."""
        monkeypatch.setattr("sys.argv", ["-c", *arguments])
        exec(compile(script, "first call", "exec"), {})
        told = IMPORT_TIMES if "importtime" in options else ""
        return subprocess.CompletedProcess(script, 0, capsys.readouterr().out, told)

    monkeypatch.setattr(identification, "_process", here)
    identification.run(tmp_path, samples=2000, repetitions=1)
    times = pd.read_csv(tmp_path / "identification.csv")
    assert (times[["wall_s_per_case", "cpu_s_per_case"]] > 0.0).all(axis=None)
    errors = pd.read_csv(tmp_path / "identification_errors.csv").set_index("name")
    # 1 % of noise on 10,000 samples: standard errors of F_k below 1 %; a wrong unit or sign would be far outside
    assert errors.loc[["direct", "fourier", identification.FIT], "F_k_error"].abs().max() < 0.05
    start = pd.read_csv(tmp_path / "start_up.csv").set_index("quantity")["wall_s"]
    assert start["both"] == pytest.approx(start["import"] + start["first call"])
    assert "Of one import, 1 ms" in (tmp_path / "identification.md").read_text("utf-8")
    assert (tmp_path / "identification.png").stat().st_size > 1000


def test_loops_write_what_they_measured(tmp_path):
    loops.run(tmp_path, sizes=[(2000, 20)])
    (row,) = pd.read_csv(tmp_path / "loops.csv").to_dict("records")
    assert row["cpu_s"] > 0.0
    assert abs(row["F_k_error"]) < 0.01  # noise of 1 % on 2000 samples
    assert "| 2,000 | 20 |" in (tmp_path / "loops.md").read_text("utf-8")


def test_the_import_is_split_by_package():
    found = identification.imports(IMPORT_TIMES).set_index("package")["seconds"]
    assert found.to_dict() == pytest.approx({"numba": 9e-4, "pandas": 1e-4})


def test_broyden_works_on_floats_and_arrays():
    def residual(u, v):
        return u * u - 2.0 * v, u + v - 4.0  # root (2, 2)

    def settled(f, g):
        return bool(np.all(np.abs(f) + np.abs(g) < 1e-12))

    for start in (1.5, np.array([1.5, 1.9])):
        u, v = broyden(residual, start, start, settled)
        assert np.allclose([u, v], 2.0, rtol=1e-11, atol=0.0)


def test_an_unknown_part_is_refused(capsys):
    with pytest.raises(SystemExit):
        command.main(["pears"])
    assert "there is no part pears; known are peers, identification" in capsys.readouterr().err
