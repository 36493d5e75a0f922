"""Table 3 of the paper from the article's recipe alone: its steps, its numbers, and no code of the package.

Every number comes from the text of the recipe as it is set; a number that the recipe did not state could not be used.
"""

from __future__ import annotations

import math
import re
import shutil

import numpy as np
import pytest

from dampbalance.features import Features
from dampbalance.project.files import write_rows
from dampbalance.publishing.article import compiling, derived_numbers
from paper_case import LEVELS, PAIRS, PAPER
from replication.routes import CASE, PRINT, ROOT, exact, numbers

pytestmark = pytest.mark.slow

TEXT = (ROOT / "paper/article/supplement/recipe.typ").read_text(encoding="utf-8")
OTHERS = (  # not numbers of a step
    "table3.t_s.F_k.1-2.from_print",
    "verdicts.table3.computed",
    "table_3.inputs",
    "table_3.given_by_exact_X",
)
WORDS = ["no", "one", "two", "three", "four", "five", "six"]


@pytest.fixture(scope="module")
def stated(tmp_path_factory):
    """A function from the key of a value to its number as the recipe prints it; fails for one that it does not."""
    folder = tmp_path_factory.mktemp("recipe")
    first = Features.from_frame(exact().features["omega1"])
    setting = derived_numbers.table(derived_numbers.setting(CASE, first))
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

    def number(key):
        assert key in texts, f"the recipe does not state {key}"
        text = texts[key]
        return float(WORDS.index(text) if text in WORDS else text)

    assert texts["scheme"] == "backward Euler"
    return number


def steps(Y, stated):
    """Steps 1 to 4: the last samples n, x, ẋ and whether the contact sticks, of the equation divided by m."""
    C, K = stated("c_over_m"), stated("k_over_m")
    F, K_z, Z_m = PAPER.F_k / PAPER.m, PAPER.K_z / PAPER.m, PAPER.F_k / PAPER.K_z
    omega, h = 2.0 * math.pi * stated("parameter.omega1"), 1e-6 * stated("step")
    per_period = 2.0 * math.pi / omega / h
    first, last = (math.floor((stated("recipe.periods") + more) * per_period) for more in (0, 1.9))
    x = v = z = 0.0
    sticks, direction = True, 0.0
    samples = []
    for n in range(1, last):
        drive = K * Y * math.cos(omega * n * h)
        stiffness = K + K_z if sticks else K
        other = -K_z * (z - x) if sticks else -direction * F
        # ẋ' = ẋ + h (drive + other − C ẋ' − stiffness x'), x' = x + h ẋ'
        new_v = (v + h * (drive + other - stiffness * x)) / (1.0 + h * C + h * h * stiffness)
        new_x = x + h * new_v
        if sticks:
            z += new_x - x
            if abs(z) > Z_m:
                sticks, direction = False, math.copysign(1.0, z)
        elif new_v * direction < 0.0:
            sticks, z = True, direction * Z_m
        x, v = new_x, new_v
        if n >= first:
            samples.append((n, x, v, sticks))
    return np.array(samples)


def read(Y, stated):
    """Steps 4 to 9, each level by itself: X and the way to slip as read (m), V_s (m/s), t_s (s), φ (rad); X in full."""
    n, x, v, sticks = steps(Y, stated).T
    h, omega = 1e-6 * stated("step"), 2.0 * math.pi * stated("parameter.omega1")
    i = int(np.flatnonzero((v[:-1] < 0.0) & (v[1:] >= 0.0))[0])
    j = i + 1 + int(np.flatnonzero((v[i + 1 : -1] >= 0.0) & (v[i + 2 :] < 0.0))[0])
    slips = i + 1 + int(np.argmax(sticks[i + 1 :] == 0.0))
    X_unit, mark, unit = (
        1e-6 * stated("recipe.X"),
        1e-6 * stated("recipe.mark"),
        1e-3 * stated("recipe.t_s_unit"),
    )
    distance = 0.5 * (x[j] - x[i + 1])
    X = round(distance / X_unit) * X_unit
    way = math.ceil((x[slips] - x[i + 1]) / mark) * mark
    reached = (2.0 * PAPER.Z_m - (x[slips - 1] - x[i + 1])) / (x[slips] - x[slips - 1])
    V_s = v[slips - 1] + reached * (v[slips] - v[slips - 1])
    t_s = math.floor((n[slips] - n[i + 1] - stated("recipe.steps")) * h / unit + 1e-9) * unit
    t_1 = (n[i] + v[i] / (v[i] - v[i + 1])) * h
    return X, way, V_s, t_s, (omega * t_1 - math.pi) % (2.0 * math.pi), distance


@pytest.fixture(scope="module")
def table(stated):
    """What is read at every level, one row each."""
    return np.array([read(Y, stated) for Y in LEVELS])


def pairs(table, stated, *, t_s=None, X=None, way=None):
    """Step 10, as the printed columns: (column, printed, computed) for every number of Table 3."""
    omega, k = 2.0 * math.pi * stated("parameter.omega1"), PAPER.k
    X = table[:, 0] if X is None else X
    t_s, way = t_s or 1e-3 * stated("recipe.t_s"), way or 1e-6 * stated("recipe.swing")
    X_s, phi, V_s = -(X - way), stated("recipe.phi"), table[:, 2]
    b, W = math.pi * omega * X**2, math.pi * k * np.array(LEVELS) * X * math.sin(phi)
    travels = {
        "t_s": 2.0 * X * (1.0 + math.cos(omega * t_s)),
        "X_s": 2.0 * (X - X_s),
        "V_s": 2.0 * X * (1.0 + np.sqrt(1.0 + (V_s / (omega * X)) ** 2)),
    }
    for i, j in PAIRS:
        for name, a in travels.items():
            matrix = np.array([[a[i], b[i]], [a[j], b[j]]])
            F_k, c = np.linalg.solve(matrix, [W[i], W[j]])
            for symbol, value in (("F_k", F_k), ("c", c)):
                printed = PRINT[f"table3.{name}.{symbol}.{i + 1}-{j + 1}"].text
                yield (
                    f"{name} {symbol} {i + 1}-{j + 1}",
                    printed,
                    f"{value:.{len(printed.partition('.')[2])}f}",
                )


def misses(cells):
    return [name for name, printed, computed in cells if printed != computed]


def test_the_recipe_gives_all_thirty_numbers(table, stated):
    cells = list(pairs(table, stated))
    assert len(cells) == 30
    assert misses(cells) == []


def test_what_the_recipe_says_of_its_readings_is_so(table, stated):
    assert table[:, 1] == pytest.approx(1e-6 * stated("recipe.swing"), abs=1e-12)
    assert np.mean(table[:, 3]) == pytest.approx(1e-3 * stated("recipe.t_s"), abs=1e-12)
    decimals = int(stated("recipe.phi_decimals"))
    assert round(float(np.mean(table[:, 4])), decimals) == stated("recipe.phi")


def test_the_digits_that_chose_the_rules(table, stated):
    """What the table beside the recipe names: each rule changed by itself."""
    one_more, one_less = (np.round(table[:, 5], decimals) for decimals in (7, 5))
    assert len(misses(pairs(table, stated, X=one_more))) >= 15
    assert len(misses(pairs(table, stated, X=one_less))) >= 15
    for way in (12e-6, 2.0 * PAPER.Z_m):
        assert misses(pairs(table, stated, way=way)) == ["X_s F_k 1-5"]
    for t_s in (2.0e-3, 2.2e-3):
        assert misses(pairs(table, stated, t_s=t_s)) == []


def test_the_steps_are_numbered_and_all_there():
    assert len(re.findall(r"^\+ ", TEXT, flags=re.MULTILINE)) == 10
