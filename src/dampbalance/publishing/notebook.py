"""Runs a notebook that is written as a plain script, and turns it into a page that needs no network.

The script is in the percent format of jupytext. Everything that would differ between two runs is excluded: the user's
IPython settings, execution times, random cell ids, dates and software versions in pictures, and output to stderr.
Metadata of a cell control how the page shows it:

    # %% alt="…"             describes the picture for readers who cannot see it
    # %% tags=["outcome"]    marks the solution of an exercise, which is folded on the page
"""

from __future__ import annotations

import base64
import html
import itertools
import os
import re
import sys
import tempfile
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

import jinja2
import jupytext  # type: ignore[import-untyped]
import nbformat
from markdown_it import MarkdownIt
from mdit_py_plugins.anchors import anchors_plugin
from mdit_py_plugins.dollarmath import dollarmath_plugin
from nbclient import NotebookClient
from nbclient.exceptions import CellExecutionError
from nbformat import NotebookNode
from pygments import highlight
from pygments.formatters import HtmlFormatter
from pygments.lexers import PythonLexer

from ..figures.style import follows_the_screen
from ..project.wording import minus
from . import formulas, words

KERNEL_SETTINGS = """\
c.HistoryManager.enabled = False
c.InlineBackend.figure_formats = {"svg"}
c.InlineBackend.print_figure_kwargs = {"bbox_inches": "tight", "metadata": {"Date": None, "Creator": None}}
"""
_MATH_AND_STOP = re.compile(r'<span class="math inline">((?:(?!</span>).)*)</span>([,.;:)]+)')
_REMOTE = re.compile(
    r"""<[^>]*\s(?:src|srcset|data|poster)\s*=\s*["']?(?:https?:)?//[^>]*"""
    r"""|<link\s[^>]*href\s*=\s*["']?(?:https?:)?//[^>]*"""
    r"""|@import|url\(\s*["']?(?:https?:)?//[^)]*"""
)


class NotebookError(RuntimeError):
    """A notebook cannot be run or shown; the message names the cell and the problem."""


def run(source: str | Path, timeout: int = 300) -> NotebookNode:
    """The notebook of a percent script, executed from top to bottom in a separate kernel.

    source : the script.   timeout : seconds that one cell may take.

    Raises NotebookError naming the cell that fails, with its error.
    """
    notebook = jupytext.read(source, fmt="py:percent")
    for number, cell in enumerate(notebook.cells, start=1):
        cell.id = f"cell-{number:02d}"
    notebook.nbformat, notebook.nbformat_minor = 4, 5  # the first version with cell ids
    with tempfile.TemporaryDirectory(prefix="nb-") as folder:
        client = NotebookClient(
            notebook,
            timeout=timeout,
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


def write(notebook: NotebookNode) -> str:
    """The notebook as the text of an .ipynb file."""
    nbformat.validate(notebook)
    return str(nbformat.writes(notebook)).rstrip("\n") + "\n"  # type: ignore[no-untyped-call]


def page(notebook: NotebookNode, style: str, template: str | Path) -> str:
    """The notebook as one self-contained HTML page: formulas as MathML, pictures as data, and the style sheet.

    style : CSS.   template : a template of Jinja with the variables title, style, contents and body.

    Raises NotebookError for a missing title, a picture without `alt`, and anything that would be loaded from elsewhere.
    """
    title = re.match(r"#\s+(.+)", notebook.cells[0].source)
    if title is None:
        raise NotebookError("the first cell of a notebook must begin with its title, '# …'")
    shown = body(notebook)
    heads = re.findall(r'<h2 id="([^"]*)">(.*?)</h2>', shown)
    page = jinja2.Template(Path(template).read_text(encoding="utf-8"), keep_trailing_newline=True)
    style = formulas.font_face(shown) + style
    text = page.render(title=title[1], style=style, contents=heads, body=shown)
    if remote := _REMOTE.search(text):
        raise NotebookError(f"the page would load from elsewhere: {remote[0][:100]}; embed it")
    # A browser may break the line between a formula and the comma after it.
    text = _MATH_AND_STOP.sub(r'<span class="together">\1\2</span>', text)
    # The label of every table, picture and equation has a number, so that labels are unique.
    numbers = {kind: itertools.count(1) for kind in ("Table", "Picture", "Equation")}
    label = rf'(?<=aria-label=")({"|".join(numbers)})(?=")'
    return re.sub(label, lambda match: f"{match[1]} {next(numbers[match[1]])}", text)


def body(notebook: NotebookNode) -> str:
    """The cells of the notebook in HTML: text, code and outputs, with the solutions of exercises folded."""
    parts: list[str] = []
    for folded, cells in itertools.groupby(
        notebook.cells, key=lambda cell: "outcome" in cell.metadata.get("tags", [])
    ):
        blocks = (block for cell in cells for block in _blocks(cell))
        fold = ["<details>\n<summary>Outcome</summary>"], ["</details>"]
        parts += [*fold[0], *blocks, *fold[1]] if folded else blocks
    return "\n".join(parts)


@cache
def _markdown() -> MarkdownIt:
    def formula(latex: str, options: dict[str, bool]) -> str:
        return (formulas.displayed if options["display_mode"] else formulas.inline)(latex)

    markdown = MarkdownIt("commonmark").use(anchors_plugin, max_level=2)
    return markdown.use(dollarmath_plugin, renderer=formula)


def _blocks(cell: NotebookNode) -> Iterator[str]:
    if cell.cell_type == "markdown":
        yield _markdown().render(cell.source)
        return
    yield highlight(cell.source, PythonLexer(), HtmlFormatter(cssclass="code", linespans=cell.id))
    yield from (_shown(output, cell) for output in cell.outputs)


def _shown(output: NotebookNode, cell: NotebookNode) -> str:
    """One output of a cell, as a picture, a table or text."""
    data = output.data if output.output_type != "stream" else {"text/plain": output.text}
    if "image/svg+xml" in data:
        alt = cell.metadata.get("alt")
        if not alt:
            raise NotebookError(f'{cell.id} shows a picture: say what is on it, # %% alt="…"')
        picture = follows_the_screen(data["image/svg+xml"])
        encoded = base64.b64encode(picture.encode()).decode()
        source = f"data:image/svg+xml;base64,{encoded}"
        image = f'<img alt="{html.escape(alt)}" src="{source}">'
        return f'<figure tabindex="0" aria-label="Picture">{image}</figure>'
    if "text/html" in data:
        return _of_html(data["text/html"], cell.id)
    return f'<pre class="output"><code>{html.escape(data["text/plain"].rstrip())}</code></pre>'


def _of_html(shown: str, cell: str) -> str:
    """Paragraphs, lists and tables of an output in HTML as the page shows them, symbols set."""
    try:
        content = ElementTree.fromstring(shown.replace("<style scoped>", "<style>"))
    except ElementTree.ParseError as error:
        raise NotebookError(f"{cell} shows HTML that is not well-formed: {error}") from None
    parts = []
    for part in content:
        if part.tag == "table":
            parts += ['<div class="table" tabindex="0" role="region" aria-label="Table">']
            parts += [*_table_lines(part), "</div>"]
        elif part.tag == "ul":
            parts.append(f"<ul>{''.join(f'<li>{_set(item)}</li>' for item in part)}</ul>")
        elif part.tag == "p":
            parts.append(f"<p>{_set(part)}</p>")
    return "\n".join(parts)


def _table_lines(table: Element) -> Iterator[str]:
    """The table of a data frame as the page shows it: each head appears once and with its scope.

    pandas writes the name of the index into a separate row below the heads, in which all other cells are empty. Here it
    is moved to the corner, and a corner that is still empty is not a head.
    """
    heads = [list(row) for row in table.iterfind("thead/tr")]
    name = heads[0][0]
    if len(heads) > 1 and not any(cell.text for cell in heads[-1][1:]):
        name = heads.pop()[0]
    rowspan = f' rowspan="{len(heads)}"' if len(heads) > 1 else ""
    corner = f'<th scope="col"{rowspan}>{_set(name)}</th>' if name.text else f"<td{rowspan}></td>"
    yield "<table>\n<thead>"
    for _, *cells in heads:
        yield f"<tr>{corner}{''.join(map(_head, cells))}</tr>"
        corner = ""
    yield "</thead>\n<tbody>"
    for label, *values in table.iterfind("tbody/tr"):
        cells_of_row = "".join(f"<td>{_set(value)}</td>" for value in values)
        yield f'<tr><th scope="row">{_set(label)}</th>{cells_of_row}</tr>'
    yield "</tbody>\n</table>"


def _head(cell: Element) -> str:
    """A cell above one column or several."""
    columns = int(cell.get("colspan", "1"))
    scope = f'scope="colgroup" colspan="{columns}"' if columns > 1 else 'scope="col"'
    return f"<th {scope}>{_set(cell)}</th>"


def _set(part: Element) -> str:
    """The text of a part with its symbols set and true minus signs."""
    return str(words.rich(minus((part.text or "").strip())))


def _environment(folder: Path) -> dict[str, str]:
    """Environment of a kernel: this interpreter, fixed settings, inline pictures, files in a temporary folder."""
    profile = folder / "ipython" / "profile_default"
    profile.mkdir(parents=True)
    (profile / "ipython_kernel_config.py").write_text(KERNEL_SETTINGS, encoding="utf-8")
    return os.environ | {
        "IPYTHONDIR": str(folder / "ipython"),
        "JUPYTER_CONFIG_DIR": str(folder / "config"),
        "JUPYTER_RUNTIME_DIR": str(folder / "runtime"),
        "MPLBACKEND": "module://matplotlib_inline.backend_inline",
        "PATH": os.pathsep.join([str(Path(sys.executable).parent), os.environ.get("PATH", "")]),
        "PYDEVD_DISABLE_FILE_VALIDATION": "1",
    }
