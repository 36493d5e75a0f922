"""Studies from Python: the numbers, the keys and the refusals of a file."""

from __future__ import annotations

import sys
from dataclasses import asdict
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest
from matplotlib import pyplot

from dampbalance import steady_orbits, study
from dampbalance.balance import APPROACHES
from dampbalance.features import Features
from dampbalance.project.documents import ConfigurationError, read_yaml
from dampbalance.solver import solve
from dampbalance.studies.study_file import PAPER_CASE, paper_defaults
from folders import PAPER_FILE
from paper_case import PAPER
from studies.documents import document

X_S = "X_s__reversal__individual__least_squares"


def test_its_numbers_are_those_of_a_file_and_names_and_arrays_stand_for_lists(computed):
    assert paper_defaults(read_yaml(PAPER_FILE)) == PAPER_CASE
    changed = document("curves", figure=None, columns=["errors"])
    changed["estimation"] |= {"terms": [["F_k", "c"]]}
    axes = {"frequency_hz": np.array([3.5, 4.92])} | changed["axes"][1]
    estimation = {"approaches": "direct,X_s", "sharing": "individual,common", "terms": "F_k,c"}
    short = study(axes, base=PAPER, estimation=estimation, columns="errors")
    pd.testing.assert_frame_equal(short.to_frame(), computed(changed)[1])


def test_what_no_study_can_be_is_refused():
    with pytest.raises(ConfigurationError, match=r"^study\(\): axes\.zetta: unknown key \(did you"):
        study({"zetta": [0.1]})
    long = {"from": 0.1, "to": 0.5, "count": 10_000}
    with pytest.raises(ConfigurationError, match=r"^study\(\): axes: 100,000,000 cases with"):
        study({"zeta": long, "F_k_N": long})


def test_the_responses_are_those_that_the_errors_come_from_which_are_shown_first():
    studied = study({"frequency_hz": [3.5, 11.1]}, levels_m=[0.004, 0.008], route="exact")
    responses, omega = studied.responses, 2.0 * np.pi * np.array([[3.5], [11.1]])
    orbits = steady_orbits(**asdict(PAPER), Y=[0.004, 0.008], omega=omega)
    np.testing.assert_array_equal(responses["X_m"], orbits.X.ravel())
    assert responses["level"].tolist() == [1, 2, 1, 2]
    assert responses["frequency_hz"].tolist() == [3.5, 3.5, 11.1, 11.1]
    errors = studied.to_frame()[f"F_k_relative_error__{X_S}"]
    for case, of_case in responses.groupby("case"):
        fit = solve(APPROACHES["X_s"](Features.from_frame(of_case), PAPER.k))
        assert fit["F_k"] / PAPER.F_k - 1.0 == pytest.approx(errors[case], rel=1e-12)
    shown = studied.summary.loc[X_S]
    assert shown["F_k largest"] == errors.abs().max()
    assert shown["F_k median"] == errors.abs().median()
    assert shown["identified"] == 1.0
    assert f"{errors.abs().max():.3g}" in repr(studied)


def test_its_plot_draws_the_errors_in_given_axes():
    f_n = np.linspace(3.5, 11.1, 30)
    studied = study({"frequency_hz": f_n}, estimation={"approaches": "X_s"})
    own = pyplot.figure().add_subplot()
    assert studied.plot("curves", ax=own) is own
    line = max(own.lines, key=lambda one: len(one.get_xdata()))
    errors = studied.to_frame()[f"F_k_relative_error__{X_S}"]
    np.testing.assert_allclose(line.get_ydata(), 100.0 * errors.abs())
    with pytest.raises(ValueError, match="no figure of the kind map suits"):
        studied.plot("map")
    pyplot.close("all")


def test_a_data_set_has_a_dimension_for_each_axis(monkeypatch):
    paired = {"zeta": [0.1, 0.2, 0.3], "K_z_over_k": [10.0, 20.0, 30.0]}
    estimation = {"approaches": "direct,X_s"}
    studied = study([paired, {"frequency_hz": [3.5, 11.1]}], estimation=estimation)
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
