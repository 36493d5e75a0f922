"""Whether a processor that lacks instructions is imitated: else its run tests nothing that others do not."""

from __future__ import annotations

import pytest

import processors
from processors import PROCESSORS

AVX2 = PROCESSORS["without-avx2"]
IMITATED = {
    "numpy": {"X86_V2"},
    "openblas": {AVX2["OPENBLAS_CORETYPE"]},
    "numba": (AVX2["NUMBA_CPU_NAME"], ""),
    "libm": "of products rounded before their sums",
}


@pytest.fixture
def here(monkeypatch):
    """What this process seems to compute with, and one without GLIBC_TUNABLES."""
    found = dict(IMITATED)
    monkeypatch.setattr(processors, "traits", lambda: found)
    monkeypatch.setattr(processors, "_libm_without", lambda variable: "of fused ones")
    return found


def test_instructions_are_off_where_they_are_to_be(capfd):
    # the child checks before pytest begins
    assert processors.run("without-avx2", ["--version"]) == 0
    out, err = capfd.readouterr()
    assert "Nothing to run" in out or "pytest 9" in out + err, out + err


def test_a_process_that_computes_as_it_should_passes(here):
    processors.check("without-avx2")


@pytest.mark.parametrize(
    ("trait", "found", "message"),
    [
        ("numpy", {"X86_V2", "X86_V3"}, "NumPy uses X86_V3"),
        ("openblas", {"Nehalem", "SkylakeX"}, "OpenBLAS computes for Nehalem, SkylakeX"),
        ("numba", ("nehalem", "+avx2"), "Numba compiles for nehalem .avx2"),
        ("libm", "of fused ones", "the C library computes as it does without GLIBC_TUNABLES"),
    ],
)
def test_one_that_does_not_is_named(here, trait, found, message):
    here[trait] = found
    with pytest.raises(RuntimeError, match=f"no processor without-avx2: {message}$"):
        processors.check("without-avx2")


def test_where_the_instructions_are_lacking_nothing_is_run(here, monkeypatch, capsys):
    monkeypatch.setattr(processors.subprocess, "run", None)
    assert processors.main([]) == 0
    assert capsys.readouterr().out.count("Nothing to run") == len(PROCESSORS)
