"""Studies from Python: the numbers, the keys and the refusals of a file."""

from __future__ import annotations

import sys
from dataclasses import asdict
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest
import yaml
from matplotlib import pyplot

from dampbalance import steady_orbits, study
from dampbalance.balance import APPROACHES, Rows
from dampbalance.features import Features
from dampbalance.project.documents import ConfigurationError, read_yaml
from dampbalance.solver import solve
from dampbalance.studies.study_file import PAPER_CASE, paper_defaults
from folders import PAPER_FILE
from paper_case import PAPER as OSCILLATOR
from studies.documents import REFUSALS, document

KEYS = ("axes", "base", "levels_m", "levels_of_Y", "estimation", "route", "read_out", "columns")
SIZES = {"zeta": 5000, "F_k_N": 4000}
X_S = "X_s__reversal__individual__least_squares"


def given(of):
    return {key: value for key, value in of.items() if key in KEYS}


@pytest.mark.parametrize("name", ["curves", "map", "steps", "sobol", "scatter"])
def test_its_numbers_are_those_of_a_file(name, computed):
    _, of_file, _ = computed(document(name))
    written = yaml.safe_load(yaml.safe_dump(document(name)))  # which sorts the axes of a sample
    pd.testing.assert_frame_equal(study(**given(written)).to_frame(), of_file)


def test_what_is_left_out_is_the_paper_s():
    assert paper_defaults(read_yaml(PAPER_FILE)) == PAPER_CASE


@pytest.mark.parametrize(
    ("change", "words"), [of[1:] for of in REFUSALS if of[0] == "good" and {*of[1]} <= {*KEYS}]
)
def test_it_refuses_what_a_file_is_refused_for(change, words):
    with pytest.raises(ConfigurationError) as caught:
        study(**given(document("good", **change)))
    assert words in str(caught.value)
    assert str(caught.value).count("study(): ") == len(str(caught.value).splitlines())


def test_arrays_names_and_an_oscillator_stand_for_what_a_file_writes_out():
    frequencies, zeta = np.array([3.5, 11.1]), {"zeta": {"from": 0.1, "to": 0.5, "count": 3}}
    short = study(
        {"frequency_hz": frequencies} | zeta,
        base=OSCILLATOR,
        levels_m=np.array([0.004, 0.008]),
        estimation={"approaches": "direct,X_s", "terms": "F_k,c"},
        columns="errors",
    )
    long = study(
        [{"frequency_hz": {"values": [3.5, 11.1]}}, zeta],
        base={"m_kg": 2.42, "k_N_per_m": 2310.0, "K_z_N_per_m": 208000.0, "F_k_N": 1.28},
        levels_m=[0.004, 0.008],
        estimation={"approaches": ["direct", "X_s"], "terms": [["F_k", "c"]]},
        columns=["errors"],
    )
    pd.testing.assert_frame_equal(short.to_frame(), long.to_frame())
    with pytest.raises(ConfigurationError, match=r"^study\(\): axes\.zetta: unknown key \(did you"):
        study({"frequency_hz": frequencies, "zetta": [0.1]})
    with pytest.raises(ConfigurationError, match=r"^study\(\): axes: 20,000,000 cases with"):
        study({name: {"from": 0.1, "to": 0.5, "count": n} for name, n in SIZES.items()})


def test_the_responses_are_those_that_the_errors_come_from(make):
    studied = study({"frequency_hz": [3.5, 11.1]}, levels_m=[0.004, 0.008], route="exact")
    responses, omega = studied.responses, 2.0 * np.pi * np.array([[3.5], [11.1]])
    orbits = steady_orbits(**asdict(OSCILLATOR), Y=[0.004, 0.008], omega=omega)
    np.testing.assert_array_equal(responses["X_m"], orbits.X.ravel())
    assert responses["level"].tolist() == [1, 2, 1, 2]
    assert responses["frequency_hz"].tolist() == [3.5, 3.5, 11.1, 11.1]
    for case, of_case in responses.groupby("case"):
        fit = solve(APPROACHES["X_s"](Features.from_frame(of_case), OSCILLATOR.k))
        error = studied.to_frame().loc[case, f"F_k_relative_error__{X_S}"]
        assert fit["F_k"] / OSCILLATOR.F_k - 1.0 == pytest.approx(error, rel=1e-12)


def test_it_shows_its_errors_first():
    studied = study({"frequency_hz": [3.5, 11.1]}, estimation={"approaches": "X_s"})
    errors = studied.to_frame()[f"F_k_relative_error__{X_S}"].abs()
    assert studied.summary.loc[X_S, "F_k largest"] == errors.max()
    assert studied.summary.loc[X_S, "F_k median"] == errors.median()
    assert f"{errors.max():.3g}" in repr(studied)
    assert f"{errors.max():.3g}" in studied._repr_html_()


def test_its_plot_draws_the_errors_in_axes_of_pyplot_or_given_ones():
    f_n = np.linspace(3.5, 11.1, 30)
    studied = study({"frequency_hz": f_n}, estimation={"approaches": "X_s"})
    axes = studied.plot()
    assert [one.get_ylabel() for one in axes] == ["error of $F_k$ (%)", "error of $c$ (%)"]
    line = max(axes[0].lines, key=lambda one: len(one.get_xdata()))
    np.testing.assert_array_equal(line.get_xdata(), f_n)
    errors = studied.to_frame()[f"F_k_relative_error__{X_S}"]
    np.testing.assert_allclose(line.get_ydata(), 100.0 * errors.abs())
    own = pyplot.figure().add_subplot()
    assert studied.plot("curves", ax=own) is own
    assert len(own.lines) == len(axes[0].lines)
    with pytest.raises(
        ValueError, match="no figure of the kind map suits a study over frequency_hz: leave"
    ):
        studied.plot("map")
    with pytest.raises(ValueError, match="figure must be one of curves, map, scatter, got 'x'"):
        studied.plot("x")
    words = study({"scheme": ["rk4"]}, route={"kind": "fixed_step", "step_s": 1e-4})
    with pytest.raises(ValueError, match="no figure suits a study over scheme: vary a number"):
        words.plot()
    pyplot.close("all")


def test_its_plot_of_two_long_axes_is_a_map():
    long = {"from": 0.1, "to": 1.0, "count": 12}
    studied = study(
        {"zeta": long, "K_z_over_k": long | {"to": 90.0}}, estimation={"approaches": "X_s"}
    )
    *panels, scale = studied.plot()
    sizes = [np.size(one.get_array()) for panel in panels for one in panel.collections]
    assert sizes.count(12 * 12) == len(panels) == 2  # F_k and c, a colour for each case
    assert scale.get_ylabel() == "error (%)"
    pyplot.close("all")


def test_a_data_set_has_a_dimension_for_each_axis(monkeypatch):
    paired = {"zeta": [0.1, 0.2, 0.3], "K_z_over_k": [10.0, 20.0, 30.0]}
    studied = study(
        [paired, {"frequency_hz": [3.5, 11.1]}], estimation={"approaches": "direct,X_s"}
    )
    monkeypatch.setitem(sys.modules, "xarray", None)
    with pytest.raises(ValueError, match="needs the package xarray: install it, or use to_frame"):
        studied.to_xarray()
    # what it would be made from: the package is not among those that are locked
    fake = SimpleNamespace(Dataset=lambda data, coords: (data, coords))
    monkeypatch.setitem(sys.modules, "xarray", fake)
    data, coords = studied.to_xarray()
    assert coords["K_z_over_k"][0] == coords["zeta"][0] == "zeta"
    dims, errors, about = data["F_k_relative_error"]
    assert dims == ("zeta", "frequency_hz", "fit")
    column = studied.to_frame()[f"F_k_relative_error__{X_S}"].to_numpy()
    np.testing.assert_array_equal(errors[..., coords["fit"].index(X_S)].ravel(), column)
    assert about == {"units": "1", "long_name": "F_k identified / true − 1"}
    dims, X = data["X_m"]
    assert dims == ("zeta", "frequency_hz", "level")
    np.testing.assert_array_equal(X.ravel(), studied.responses["X_m"])


def test_rows_of_an_approach_are_asked_for_at_call_and_for_one_term_by_its_name():
    studied = study({"zeta": [0.1, 0.2]})
    assert {fit.approach for fit in studied.settings.fits} == {*APPROACHES}
    features = Features.from_frame(studied.responses)
    rows = APPROACHES["direct"](features, OSCILLATOR.k, "F_k")
    assert isinstance(rows, Rows)
    assert list(rows.terms) == ["F_k"]
