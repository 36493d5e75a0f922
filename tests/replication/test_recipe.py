"""Table 3 of the paper from the article's recipe alone: its steps, its numbers, and no code of the package.

Every number comes from the text of the recipe as it is set; a number that the recipe did not state could not be used.
"""

from __future__ import annotations

import itertools
import math
import re
import shutil

import numpy as np
import pytest

from dampbalance.project.files import write_rows
from dampbalance.publishing.article import compiling, derived_numbers
from paper_case import LEVELS, PAPER, features_at
from replication.by_hand import backward_euler, missed
from replication.routes import CASE, ROOT, numbers

pytestmark = pytest.mark.slow

TEXT = (ROOT / "paper/article/supplement/recipe.typ").read_text(encoding="utf-8")
OTHERS = ("table3.t_s.F_k.1-2.from_print", "verdicts.table3.computed")  # not numbers of a step
WORDS = {"one": 1.0, "two": 2.0, "three": 3.0}


@pytest.fixture(scope="module")
def stated(tmp_path_factory):
    """The numbers that the recipe prints, by the key of the value, in SI units."""
    folder = tmp_path_factory.mktemp("recipe")
    setting = derived_numbers.table(derived_numbers.setting(CASE, features_at()))
    for name in ("values.typ", "numbers.typ"):
        shutil.copy(ROOT / "paper/article" / name, folder)
    tables = {"derived": setting, "numbers": numbers().to_dict("records"), "claims": [{"id": "-"}]}
    for name, rows in tables.items():
        write_rows(folder / f"{name}.csv", rows)
    keys = [key for key in re.findall(r'#(?:v|n|words)\("([^"]+)"\)', TEXT) if key not in OTHERS]
    source = b"""#import "values.typ": value-of
        #metadata(json(bytes(sys.inputs.given)).keys.map(key => (key, value-of(key).text)))<texts>"""
    sources = {f"/{name}.csv": "-" for name in tables}
    inputs = {"results": "", "studies": "", "sources": sources, "keys": keys}
    texts = dict(compiling.query(source, folder, inputs, "<texts>", "value")[0])
    assert texts.pop("scheme") == "backward Euler"
    units = {"recipe.t_s": 1e-3, "recipe.t_s_unit": 1e-3}  # ms; steps, X and marks in µm or µs
    units |= dict.fromkeys(("step", "recipe.X", "recipe.mark", "recipe.swing"), 1e-6)
    by_key = {key: WORDS.get(text) or text for key, text in texts.items()}
    return {
        key: units.get(key, 1.0) * float(text)
        for key, text in by_key.items()
        if key != "recipe.slip_samples"
    }


def read(Y, stated):
    """Steps 1 to 9, each level by itself: X in full, the way to slip as read, V_s, t_s and φ."""
    h, omega = stated["step"], 2.0 * math.pi * stated["parameter.omega1"]
    first, last = (
        math.floor((stated["recipe.periods"] + more) * 2.0 * math.pi / omega / h)
        for more in (0.0, 1.9)
    )
    motion = backward_euler(stated["c_over_m"], stated["k_over_m"], Y, omega, h, last)
    x, v, _, sticks = np.array([*itertools.islice(motion, first - 1, None)]).T
    i = int(np.flatnonzero((v[:-1] < 0.0) & (v[1:] >= 0.0))[0])
    j = i + 1 + int(np.flatnonzero((v[i + 1 : -1] >= 0.0) & (v[i + 2 :] < 0.0))[0])
    slips = i + 1 + int(np.argmax(sticks[i + 1 :] == 0.0))
    mark, unit = stated["recipe.mark"], stated["recipe.t_s_unit"]
    way = math.ceil((x[slips] - x[i + 1]) / mark) * mark
    reached = (2.0 * PAPER.Z_m - (x[slips - 1] - x[i + 1])) / (x[slips] - x[slips - 1])
    V_s = v[slips - 1] + reached * (v[slips] - v[slips - 1])
    t_s = math.floor((slips - i - 1 - stated["recipe.steps"]) * h / unit + 1e-9) * unit
    t_1 = (first + i + v[i] / (v[i] - v[i + 1])) * h
    phi = (omega * t_1 - math.pi) % (2.0 * math.pi)
    return 0.5 * (x[j] - x[i + 1]), way, V_s, t_s, phi


def test_the_recipe_gives_all_thirty_numbers_by_the_digits_that_chose_its_rules(stated):
    """Step 10, and what the table beside the recipe names: each rule changed by itself."""
    X, way, V_s, t_s, phi = np.array([read(Y, stated) for Y in LEVELS]).T
    # what the recipe says of its readings is so
    assert way == pytest.approx(stated["recipe.swing"], abs=1e-12)
    assert np.mean(t_s) == pytest.approx(stated["recipe.t_s"], abs=1e-12)
    assert round(float(np.mean(phi)), int(stated["recipe.phi_decimals"])) == stated["recipe.phi"]
    inputs = {"X": np.round(X / stated["recipe.X"]) * stated["recipe.X"], "V_s": V_s}
    inputs |= {name: stated[f"recipe.{name}"] for name in ("phi", "t_s")}
    inputs |= {"way": stated["recipe.swing"], "omega": 2.0 * math.pi * stated["parameter.omega1"]}
    assert missed(**inputs) == []
    for decimals in (7, 5):
        assert len(missed(**inputs | {"X": np.round(X, decimals)})) >= 15
    for other in (12e-6, 2.0 * PAPER.Z_m):
        assert missed(**inputs | {"way": other}) == ["X_s F_k 1-5"]
    for other in (2.0e-3, 2.2e-3):
        assert missed(**inputs | {"t_s": other}) == []
    assert len(re.findall(r"^\+ ", TEXT, flags=re.MULTILINE)) == 10
