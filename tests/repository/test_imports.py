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
    # pandas reads text, with pyarrow where that is installed
    assert loaded(program) == {"numpy", "pandas", "pyarrow", "scipy"} | needed
