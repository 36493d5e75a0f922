"""Run a notebook that is written as a plain script.

The script is in the percent format of jupytext. Everything that would differ between two runs is excluded: the user's
settings of IPython and matplotlib, execution times, random cell ids, dates, names and software versions in pictures,
and output to stderr. Metadata of a cell stay in the notebook:

    # %% alt="…"             describes the picture for readers who cannot see it
    # %% tags=["outcome"]    marks the solution of an exercise
"""

from __future__ import annotations

import os
import sys
import tempfile
from pathlib import Path

import jupytext  # type: ignore[import-untyped]
import nbformat
from nbclient import NotebookClient
from nbclient.exceptions import CellExecutionError
from nbformat import NotebookNode

KERNEL_SETTINGS = """\
c.HistoryManager.enabled = False
c.InlineBackend.figure_formats = {"svg"}
c.InlineBackend.print_figure_kwargs = {"bbox_inches": "tight", "metadata": {"Date": None, "Creator": None}}
"""


class NotebookError(RuntimeError):
    """A notebook cannot be run; the message names the cell and the problem."""


def run_notebook(source: str | Path) -> NotebookNode:
    """Return the notebook of a percent script, executed from top to bottom in a separate kernel.

    Raises NotebookError naming the cell that fails, with its error.
    """
    notebook = jupytext.read(source, fmt="py:percent")
    for number, cell in enumerate(notebook.cells, start=1):
        cell.id = f"cell-{number:02d}"
    notebook.nbformat, notebook.nbformat_minor = 4, 5  # the first version with cell ids
    with tempfile.TemporaryDirectory(prefix="nb-") as folder:
        client = NotebookClient(
            notebook,
            timeout=300,  # s, of a cell
            kernel_name="python3",
            record_timing=False,
            shutdown_kernel="immediate",  # all outputs are here by then
            resources={"metadata": {"path": str(Path(source).parent)}},
        )
        manager = client.create_kernel_manager()
        if os.name != "nt":  # sockets in a folder of our own
            manager.transport, manager.ip = "ipc", str(Path(folder) / "socket")
        manager.connection_file = str(Path(folder) / "connection.json")
        try:
            client.execute(env=_environment(Path(folder)))
        except CellExecutionError as error:
            failed = [
                any(output.output_type == "error" for output in cell.get("outputs", []))
                for cell in notebook.cells
            ].index(True)
            raise NotebookError(
                f"{source}: cell {failed + 1} fails with {error.ename}: {error.evalue}\n\n"
                f"{notebook.cells[failed].source}"
            ) from None
    # Nothing stays that depends on the run or the machine; stderr is passed on.
    notebook.metadata.pop("jupytext", None)
    notebook.metadata.get("language_info", {}).pop("version", None)
    for cell in notebook.cells:
        for output in list(cell.get("outputs", [])):
            if output.output_type == "stream" and output.name == "stderr":
                print(output.text, file=sys.stderr, end="")
                cell.outputs.remove(output)
    return notebook


def write_notebook(notebook: NotebookNode) -> str:
    """Return the notebook as the text of an .ipynb file."""
    nbformat.validate(notebook)
    return str(nbformat.writes(notebook)).rstrip("\n") + "\n"  # type: ignore[no-untyped-call]


def _environment(folder: Path) -> dict[str, str]:
    """Return the environment of a kernel: this interpreter, fixed settings, inline pictures, a temporary folder."""
    profile = folder / "ipython" / "profile_default"
    profile.mkdir(parents=True)
    (profile / "ipython_kernel_config.py").write_text(KERNEL_SETTINGS, encoding="utf-8")
    # names inside a picture follow from its content; settings of the user are ignored like those of IPython
    (folder / "matplotlibrc").write_text("svg.hashsalt: dampbalance\n", encoding="utf-8")
    return os.environ | {
        "MATPLOTLIBRC": str(folder / "matplotlibrc"),
        "IPYTHONDIR": str(folder / "ipython"),
        "JUPYTER_CONFIG_DIR": str(folder / "config"),
        "JUPYTER_RUNTIME_DIR": str(folder / "runtime"),
        "MPLBACKEND": "module://matplotlib_inline.backend_inline",
        "PATH": os.pathsep.join([str(Path(sys.executable).parent), os.environ.get("PATH", "")]),
        "PYDEVD_DISABLE_FILE_VALIDATION": "1",
    }
