"""What is started often loads only what it needs: a package that takes long to import is one that is used."""

from __future__ import annotations

import sys

import pytest

from processes import run

HEAVY = {"numpy", "scipy", "pandas", "numba", "matplotlib", "pyarrow", "jsonschema"}


def loaded(program: str) -> set[str]:
    """The heavy packages that a process has loaded when it has run this program."""
    listing = f"\nimport sys\nprint(*(set({sorted(HEAVY)}) & sys.modules.keys()), file=sys.stderr)"
    done = run(sys.executable, "-c", program + listing)
    assert done.returncode == 0, done.stderr
    return set(done.stderr.split())


def test_the_command_line_says_what_it_can_do_with_the_standard_library():
    program = (
        "import contextlib, io\n"
        "from dampbalance.commands.main import main\n"
        "for arguments in ([], ['--help'], ['--version']):\n"
        "    with contextlib.suppress(SystemExit), contextlib.redirect_stderr(io.StringIO()):\n"
        "        main(arguments)"
    )
    assert loaded(program) == set()


@pytest.mark.parametrize(("arguments", "needed"), [(["--no-figures"], set()), ([], {"matplotlib"})])
def test_an_identification_loads_what_it_uses(arguments, needed, tmp_path):
    records = [f"config/records/example/level{i}.csv" for i in (1, 5)]
    given = ["identify", *records, "--stiffness", "2310", "--output", str(tmp_path), *arguments]
    program = f"from dampbalance.commands.main import main\nmain({given})"
    assert loaded(program) == {"numpy", "scipy"} | needed


# Importing a script imports what it needs; it computes when Snakemake runs it. Those that lack the same share a
# process: what none of them has loaded in the end, no one of them loads.
@pytest.mark.parametrize(
    ("scripts", "unneeded"),
    [
        (
            (
                *("features/features_exact", "features/features_as_published", "claims/check"),
                *("tables/tables", "studies/study_cases", "studies/study_chunk"),
            ),
            {"matplotlib", "numba", "scipy"},
        ),
        (
            ("estimates/estimate_exact", "simulate/simulate_exact"),
            {"matplotlib", "numba", "scipy", "pandas"},
        ),
        (("figures/figures",), {"numba", "pandas", "scipy"}),
        (("studies/study_summary", "page/page"), {"matplotlib", "numba"}),
        (("studies/study_figure",), {"numba"}),
        (("article/article", "provenance/manifest"), HEAVY),
    ],
)
def test_a_script_loads_what_it_uses(scripts, unneeded):
    program = (
        "import runpy, sys\n"
        f"for script in {scripts}:\n"
        "    runpy.run_path(f'workflow/scripts/{script}.py', run_name='imported')\n"
        f"    assert not {unneeded} & sys.modules.keys(), script"
    )
    assert not loaded(program) & unneeded
