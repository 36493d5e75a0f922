"""The values that a figure keeps in its SVG: those of lines with a name."""

from __future__ import annotations

from xml.etree import ElementTree

import numpy as np
import pytest
from matplotlib.figure import Figure

from dampbalance.figures.style import save_svg
from dampbalance.figures.values import MOST_PLACES, read_values


@pytest.fixture
def axes():
    return Figure(figsize=(4.0, 3.0)).add_axes((0.25, 0.5, 0.5, 0.25))


def saved(axes, path):
    """The only panel of a figure that was written and read."""
    save_svg(axes.figure, path)
    svg = path.read_text(encoding="utf-8")
    ElementTree.fromstring(svg)
    (panel,) = read_values(svg)
    return panel


def test_lines_with_a_name_keep_their_values(axes, tmp_path):
    axes.plot([0.0, 1.0, 2.0], [1.0, np.nan, 100.0], gid="$a$ < b & c")
    axes.plot([0.0, 2.0], [1.0, 1.0])  # without a name: it only guides the eye
    axes.set(xlim=(0.0, 2.0), ylim=(1.0, 100.0), yscale="log", xlabel="$x$", ylabel="y", title="t")
    panel = saved(axes, tmp_path / "a.svg")
    assert (panel["title"], panel["x"], panel["y"]) == ("t", "$x$", "y")
    (block,) = panel["blocks"]
    assert block["places"] == [0.0, 1.0, 2.0]
    assert block["lines"] == [["$a$ < b & c", [1.0, None, 100.0]]]


def test_saving_leaves_the_names_and_gives_the_same_bytes(axes, tmp_path):
    (line,) = axes.plot([0.0, 1.0], [0.0, 1.0], gid="a line")
    for name in ("a.svg", "b.svg"):
        saved(axes, tmp_path / name)
    assert line.get_gid() == "a line"
    assert (tmp_path / "a.svg").read_bytes() == (tmp_path / "b.svg").read_bytes()
    assert 'id="a line"' not in (tmp_path / "a.svg").read_text(encoding="utf-8")


def test_named_places_keep_their_names_and_rows_are_read_along_x(axes, tmp_path):
    axes.plot([3.0, 4.0], [0, 1], gid="c")
    axes.set_yticks(range(2), ["one", "two"])
    panel = saved(axes, tmp_path / "a.svg")
    assert (panel["x"], panel["y"]) == ("", "")
    assert panel["blocks"][0]["places"] == ["one", "two"]
    assert panel["blocks"][0]["lines"][0][1] == [3.0, 4.0]


def test_a_long_line_is_thinned_and_a_loop_keeps_what_the_panel_shows(axes, tmp_path):
    turn = np.linspace(0.0, 2.0 * np.pi, 1000)
    axes.plot(np.cos(turn), np.sin(turn), gid="loop")
    axes.set(xlim=(0.0, 2.0), ylim=(0.0, 2.0))  # a quarter of it
    places, (_, heights) = (
        (block := saved(axes, tmp_path / "a.svg")["blocks"][0])["places"],
        block["lines"][0],
    )
    assert MOST_PLACES / 2 < len(places) <= MOST_PLACES + 1
    np.testing.assert_allclose(np.hypot(places, heights), 1.0, rtol=1e-5)


def test_a_figure_without_names_has_no_values(axes, tmp_path):
    axes.plot([0.0, 1.0], [0.0, 1.0])
    save_svg(axes.figure, tmp_path / "a.svg")
    assert read_values((tmp_path / "a.svg").read_text(encoding="utf-8")) == []
