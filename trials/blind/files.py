"""Files in the shapes that loggers, apps, video trackers and test machines write: what is read of each at once.

A free decay of a mass, or of a pendulum at small angles, on a spring, a damper and a slider, or loops of a slider on a
test machine, in a file as the maker of a program, or a student, would write it. The motion comes from
`other_motion`, in fixed steps; nothing but the answer comes from the package, which is asked by its command.

A shape is right at once where f_n, or F_k and c, or K_z, are within `WITHIN`; after one change where the message named
that change; a file that holds nothing to identify is right where the message says what it is. A drive, a unit or a rate
in a draft that the file does not have is invented.
"""

from __future__ import annotations

import contextlib
import io
import json
import math
import re
import tempfile
import warnings
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from scipy.io import savemat

from dampbalance.commands.main import main
from dampbalance.project.wording import markdown_table

from .other_motion import Rig, follow, one_slider

_FILES = 59  # so that the draws are not those of other sets
WITHIN = 0.1
_F_N = 0.02  # of the natural frequency
_INVENTED = r"base_(displacement|acceleration): \{|sample_rate_hz: \d|force_N: 1|scale: 1\.0"

Random = np.random.Generator
Columns = dict[str, np.ndarray]


@dataclass
class Motion:
    """A decay: times, s, displacement, velocity and acceleration (SI), and what is true of it."""

    t: np.ndarray
    x: np.ndarray
    v: np.ndarray
    a: np.ndarray
    k: float
    truth: dict[str, float]

    def at(self, rows: Any) -> Motion:
        """Return some of its samples."""
        return replace(self, t=self.t[rows], x=self.x[rows], v=self.v[rows], a=self.a[rows])


@dataclass
class File:
    """A file and how it is identified.   truth : symbol → value; empty where the file must be refused.   named : words
    that a message must hold: of what the file is, or of the one change, which `changed` makes."""

    name: str
    content: str | bytes
    arguments: list[str]
    truth: dict[str, float] = field(default_factory=dict)
    named: tuple[str, ...] = ()
    changed: File | None = None


def decay(random: Random, rate: float = 200.0, seconds: float = 12.0, **of: Any) -> Motion:
    """Return the release of a rig drawn at random.   pendulum : small, in rad; rest : s for which it was held; hertz :
    its natural frequency; noise : of its largest value."""
    f_n = of.get("hertz") or random.uniform(0.7, 3.0)
    m, X = random.uniform(0.5, 5.0), random.uniform(0.01, 0.05)
    if of.get("pendulum"):
        m, X = random.uniform(0.005, 0.05), random.uniform(0.08, 0.2)
    omega = 2.0 * math.pi * f_n
    k, c = m * omega**2, 2.0 * random.uniform(0.002, 0.01) * m * omega
    F_k = k * X / random.uniform(60.0, 120.0)
    contact = one_slider(k * random.uniform(10.0, 40.0), F_k)
    every = max(1, math.ceil(omega / rate * 400))
    out = np.empty((3, int(seconds * rate)))
    state, force = np.array([X, 0.0, 0.0, 0.0]), np.array([F_k])
    follow(Rig(m, c, k), contact, state, force, 0.0, 1.0 / rate / every, every, out)
    held = np.tile([[X], [0.0], [0.0]], int(of.get("rest", 0.0) * rate))
    moves, noise = np.hstack([held, out]), of.get("noise", 2e-4)
    x, v, a = (y + noise * np.ptp(y) / 2 * random.standard_normal(y.size) for y in moves)
    return Motion(np.arange(x.size) / rate, x, v, a, k, {"F_k": F_k, "c": c, "f_n": f_n})


def csv(columns: Columns, sep: str = ",", form: str = "%.7g", head: bool = True) -> str:
    """Return columns as a text."""
    return pd.DataFrame(columns).to_csv(index=False, sep=sep, float_format=form, header=head)


def of_decay(m: Motion, content: Columns | str | bytes, name: str = "run.csv", **how: Any) -> File:
    """Return the file of a decay."""
    text = csv(content, **how) if isinstance(content, dict) else content
    return File(name, text, ["--stiffness", f"{m.k:.5g}"], m.truth)


def asking(file: File, named: tuple[str, ...], content: str | bytes, name: str = "") -> File:
    """Return a file of which a message must name the change to another content."""
    return replace(
        file, named=named, changed=replace(file, content=content, name=name or file.name)
    )


SHAPES: dict[str, Callable[[Random], File]] = {}
"""Shapes that issues, manuals and forums show, by name."""


def shape(of: Callable[[Random], File]) -> Callable[[Random], File]:
    """Enter a shape by the name of its function."""
    SHAPES[of.__name__.replace("_", " ")] = of
    return of


_MOTION = ("pendulum", "rate", "rest", "hertz", "seconds")


def _columns(name: str, of: Callable[[Motion, Random], Columns | str], **how: Any) -> None:
    """Enter a shape that is a table of columns, or a text, of a decay."""
    wanted = {key: how.pop(key) for key in (*how,) if key in _MOTION}

    def made(random: Random) -> File:
        own = {key: value(random) if callable(value) else value for key, value in wanted.items()}
        m = decay(random, **own)
        return of_decay(m, of(m, random), **how)

    SHAPES[name] = made


_DEG = 180.0 / math.pi
_columns(
    "empty column",
    lambda m, _: {"time_s": m.t, "displacement_m": m.x, "aux": np.full(m.t.size, np.nan)},
)
_columns(
    "unconnected channel",
    lambda m, r: {
        "time_s": m.t,
        "ch2": 30.189 + 0.0006 * r.standard_normal(m.t.size),
        "displacement_m": m.x,
    },
)
_columns("velocity_5", lambda m, _: {"time_s": m.t, "velocity_5 (m/s)": m.v})
_columns("dist in mm", lambda m, _: {"t (s)": m.t, "dist (mm)": 1e3 * m.x})
_columns(
    "arc of a bob",
    lambda m, _: {"t": m.t, "x": 0.4 * np.sin(m.x), "y": 0.4 * (1.0 - np.cos(m.x)), "θ": m.x},
    pendulum=True,
)
_columns(
    "x, v and a",
    lambda m, _: {
        "Time (s)": m.t,
        "Position (m)": m.x,
        "Velocity (m/s)": m.v,
        "Acceleration (m/s²)": m.a,
    },
)
_columns(
    "angle and angular velocity",
    lambda m, _: {"time (s)": m.t, "angle (rad)": m.x, "angular velocity (rad/s)": m.v},
    pendulum=True,
)


def _noise(m: Motion, random: Random, size: float) -> np.ndarray:
    return size * random.standard_normal((2, m.t.size))


@shape
def three_axes(random: Random) -> File:
    m = decay(random)
    n = _noise(m, random, 0.02)
    return of_decay(
        m, {"time_s": m.t, "ax (m/s^2)": n[0], "ay (m/s^2)": m.a, "az (m/s^2)": 9.81 + n[1]}
    )


@shape
def jitter(random: Random) -> File:
    m = decay(random, rate=1000.0)
    steps = random.uniform(0.0225, 0.0275, 600)
    steps[300] = 0.04
    t = np.cumsum(steps)
    t = t[t < m.t[-1]]
    return of_decay(m, {"time_s": t, "displacement_m": np.interp(t, m.t, m.x)})


@shape
def drifting_clock(random: Random) -> File:
    m = decay(random)
    drift = 0.0005 * m.t**2 / m.t[-1] * random.uniform(0.5, 1.5)
    return of_decay(m, {"time_s": m.t + drift, "displacement_m": m.x})


@shape
def encoder_ticks(random: Random) -> File:
    m = decay(random, rate=5000.0, pendulum=True, noise=0.0)
    tick = 2.0 * math.pi / 4096
    counts = np.round(m.x / tick)
    at = np.flatnonzero(np.diff(counts)) + 1
    return of_decay(m, {"time_s": m.t[at], "angle_rad": counts[at] * tick})


@shape
def missing_line(random: Random) -> File:
    m = decay(random)
    own = m.at(np.arange(m.t.size) != m.t.size // 3)
    return of_decay(m, {"time_s": own.t, "displacement_m": own.x})


_columns("rounded stamps", lambda m, _: {"time_s": np.round(m.t, 2), "displacement_m": m.x})


@shape
def lone_last_line(random: Random) -> File:
    m = decay(random)
    t = np.append(m.t, m.t[-1] + 31.0)
    return of_decay(m, {"time_s": t, "displacement_m": np.append(m.x, m.x[-1])})


@shape
def padded_export(random: Random) -> File:
    m = decay(random)
    t, x = (np.append(of, np.full(40, of[-1])) for of in (m.t, m.x))
    return of_decay(m, {"time_s": t, "displacement_m": x})


_columns(
    "rest before",
    lambda m, _: {"time_s": m.t, "displacement_m": m.x},
    rest=lambda random: random.uniform(1.0, 4.0),
)


@shape
def two_rates(random: Random) -> File:
    m = decay(random)
    own = m.at((m.t <= 0.8 * m.t[-1]) | (np.arange(m.t.size) % 10 == 0))
    return of_decay(m, {"time_s": own.t, "displacement_m": own.x})


@shape
def second_run(random: Random) -> File:
    m = decay(random)
    once = csv({"time_s": m.t, "displacement_m": m.x})
    named = ("second run", str(m.t.size + 2))
    return asking(of_decay(m, once + once.split("\n", 1)[1]), named, once)


_columns(
    "times without a unit",
    lambda m, _: {"time": m.t, "displacement (mm)": 1e3 * m.x},
    rate=20.0,
    seconds=25.0,
)
for _word, _unit, _scale in (
    ("position", "m", 1.0),
    ("pos", "cm", 100.0),
    ("weg", "mm", 1e3),
    ("theta", "rad", 1.0),
    ("angle", "", 1.0),
    ("pitch", "deg", _DEG),
):
    _columns(
        f"word {_word}",
        lambda m, _, word=_word, unit=_unit, scale=_scale: {
            "time (s)": m.t,
            f"{word} ({unit})" if unit else word: scale * m.x,
        },
        pendulum=_word in ("theta", "angle", "pitch"),
    )


@shape
def word_roll(random: Random) -> File:
    m = decay(random, pendulum=True)  # an angle of some degrees: in rad it would be large
    file = of_decay(m, {"time (s)": m.t, "roll": _DEG * m.x})
    return asking(file, ("in which unit", "roll"), csv({"time (s)": m.t, "roll (deg)": _DEG * m.x}))


_columns("Vernier", lambda m, _: {"Data Set 1:Time(s)": m.t, "Data Set 1:Position(m)": m.x})
_columns(
    "Logger Pro",
    lambda m, _: {
        "Latest: Time (s)": m.t,
        "Latest: Position (m)": m.x,
        "Latest: Velocity (m/s)": m.v,
    },
)


@shape
def tracker(random: Random) -> File:
    m = decay(random, pendulum=True)
    columns = {"t": m.t, "x": 0.4 * np.sin(m.x), "y": -0.4 * np.cos(m.x), "θ": m.x}
    return of_decay(m, "mass A\n" + csv(columns, sep="\t", form="%.6E"), "track.txt")


@shape
def klipper(random: Random) -> File:
    m = decay(random, rate=3200.0, hertz=random.uniform(30.0, 60.0), seconds=2.0)
    n = _noise(m, random, 20.0)
    columns = {
        "#time": m.t + 812.0,
        "accel_x": 1e3 * m.a,
        "accel_y": n[0],
        "accel_z": 9810.0 + n[1],
    }
    return of_decay(m, columns, form="%.9g")


@shape
def lvm_without_a_head(random: Random) -> File:
    m = decay(random)
    text = csv({"a": m.t, "b": m.x}, sep="\t", head=False)
    return asking(
        of_decay(m, text, "run.lvm"), ("column",), "time_s\tdisplacement_m\n" + text, "run.txt"
    )


@shape
def tab_before_each_line(random: Random) -> File:
    m = decay(random)
    lines = csv({"time_s": m.t, "displacement_m": m.x}, sep="\t").splitlines()
    return of_decay(m, "".join(f"\t{line}\n" for line in lines), "run.txt")


def _mat(**held: np.ndarray) -> bytes:
    file = io.BytesIO()
    savemat(file, held)
    return file.getvalue()


@shape
def mat_with_one_matrix(random: Random) -> File:
    m = decay(random)
    file = of_decay(m, _mat(data=np.column_stack([m.t, m.x])), "run.mat")
    return asking(file, ("column",), _mat(time_s=m.t, displacement_m=m.x))


@shape
def runs_side_by_side(random: Random) -> File:
    m = decay(random)
    head = "Time (s),Position (m),,Time (s),Position (m)\n"  # the same body, released twice
    again = m.x + 2e-4 * np.ptp(m.x) * random.standard_normal(m.x.size)
    rows = zip(m.t, m.x, again, strict=True)
    return of_decay(m, head + "".join(f"{t:.6g},{x:.6g},,{t:.6g},{y:.6g}\n" for t, x, y in rows))


def loop(random: Random, cycles: int = 12, per: int = 200) -> tuple[np.ndarray, ...]:
    """Return times, s, displacement, m, force, N, of a slider under a sine, and (F_k, K_z)."""
    F, X, hertz = random.uniform(5.0, 500.0), random.uniform(1e-3, 1e-2), random.uniform(0.2, 1.0)
    K = F / (X * random.uniform(0.1, 0.3))
    turn = np.arange(per * cycles) / per
    x, z, force = X * np.sin(2.0 * math.pi * turn), 0.0, np.empty(turn.size)
    for i, dx in enumerate(np.diff(x, prepend=0.0)):
        force[i] = z = min(max(z + K * dx, -F), F)
    return turn / hertz, x, force + 0.005 * F * random.standard_normal(x.size), np.array([F, K])


def _of_loop(name: str, of: Callable[..., Columns], **how: Any) -> None:
    """Enter a shape that is a table of loops."""

    def made(random: Random) -> File:
        t, x, f, (F, K) = loop(random)
        return File("loop.csv", csv(of(t, x, f), **how), [], {"F_k": F, "K_z": K})

    SHAPES[name] = made


_of_loop(
    "MR damper",
    lambda t, x, f: {
        "time (s)": t,
        "displacement (m)": x,
        "force (N)": f,
        "velocity 1 (m/s)": np.gradient(x, t),
        "velocity 2 (m/s)": 1.001 * np.gradient(x, t),
        "velocity 3 (m/s)": np.roll(np.gradient(x, t), 1),
    },
)
_of_loop(
    "loops without times", lambda t, x, f: {"displacement (mm)": 1e3 * x, "force (kN)": 1e-3 * f}
)
_of_loop("position and forc", lambda t, x, f: {"t(s)": t, "position (m)": x, "forc (N)": f})


@shape
def loops_without_a_head(random: Random) -> File:
    _, x, f, (F, K) = loop(random)
    text = csv({"a": 1e3 * x, "b": f}, sep="\t", head=False)
    file = File("loop.txt", text, [], {"F_k": F, "K_z": K})
    return asking(file, ("column",), "displacement (mm)\tforce (N)\n" + text)


@shape
def loops_in_german(random: Random) -> File:
    t, x, f, (F, K) = loop(random)
    text = csv({"Zeit [s]": t, "Weg [mm]": 1e3 * x, "Kraft [N]": f}, sep=";").replace(".", ",")
    return File("prüfung.csv", text, [], {"F_k": F, "K_z": K})


@shape
def hammer_without_a_name(random: Random) -> File:
    m = decay(random)
    blow = np.where(np.arange(m.t.size) < 4, 50.0, 0.0) + 0.01 * random.standard_normal(m.t.size)
    return of_decay(m, {"time_s": m.t, "in1": blow, "displacement_m": m.x})


@shape
def frequency_response(random: Random) -> File:
    f, f_n = np.arange(1, 800) * 2.5, random.uniform(300.0, 900.0)
    H = 1.0 / (1.0 - (f / f_n) ** 2 + 0.02j)
    text = csv({"Frequency (Hz)": f, "Magnitude": np.abs(H), "Phase": np.degrees(np.angle(H))})
    return File("frf.csv", text, ["--stiffness", "1000"], named=("frequency response",))


@shape
def seven_samples_a_cycle(random: Random) -> File:
    m = decay(random, rate=20.0, hertz=random.uniform(2.7, 3.0), seconds=40.0)
    m.truth = {"f_n": m.truth["f_n"]}
    return of_decay(m, {"time_s": m.t, "acceleration (g)": m.a / 9.80665})


_columns(
    "long decay",
    lambda m, _: {"time_s": m.t, "velocity (m/s)": m.v},
    rate=2000.0,
    hertz=lambda random: random.uniform(80.0, 120.0),
    seconds=20.0,
)


def _comma(text: str) -> str:
    return text.replace(".", ",")


def _stamped(m: Motion, form: str) -> list[str]:
    start = pd.Timestamp("2026-03-05 10:41:07.25")
    return [f"{(start + pd.Timedelta(t, 's')).strftime(form)[:-3]}" for t in m.t]


_columns("Capstone", lambda m, _: {"Time (s) Run #1": m.t, "Position (m) Run #1": m.x})
_columns(
    "IMU on a microcontroller",
    lambda m, r: {
        "millis": np.round(1e3 * m.t),
        "ax": m.a / 9.80665,
        **dict(zip(("ay", "gx"), _noise(m, r, 0.003), strict=True)),
        "az": 1.0 + 0.003 * r.standard_normal(m.t.size),
    },
)
_columns(
    "Physics Toolbox",
    lambda m, r: {
        "time": m.t,
        "gFx": _noise(m, r, 0.002)[0],
        "gFy": m.a / 9.80665,
        "gFz": 1.0 + _noise(m, r, 0.002)[1],
    },
)
_columns(
    "French",
    lambda m, _: _comma(csv({"Temps (s)": m.t, "Position (cm)": 1e2 * m.x}, sep=";")),
)
_columns("Spanish", lambda m, _: {"Tiempo (s)": m.t, "Posición (m)": m.x})
_columns(
    "German in ms",
    lambda m, _: _comma(csv({"Zeit [ms]": 1e3 * m.t, "Auslenkung [mm]": 1e3 * m.x}, sep=";")),
)
_columns(
    "index of pandas",
    lambda m, _: pd.DataFrame({"time_s": m.t, "displacement_m": m.x}).to_csv(float_format="%.7g"),
)
_columns(
    "dates",
    lambda m, _: {"timestamp": _stamped(m, "%Y-%m-%d %H:%M:%S.%f"), "displacement_mm": 1e3 * m.x},
)
_columns(
    "time of day", lambda m, _: {"time": _stamped(m, "%H:%M:%S.%f"), "displacement_mm": 1e3 * m.x}
)
_columns(
    "vibrometer", lambda m, _: {"Time [ s ]": m.t, "Velocity (Vib) [ mm/s ]": 1e3 * m.v}, sep=";"
)
_columns(
    "comments",
    lambda m, _: (
        "% release 3\n% t[s]  x[mm]\n" + csv({"": m.t, " ": 1e3 * m.x}, sep=" ", head=False)
    ),
)
_columns(
    "separator named", lambda m, _: "sep=;\n" + csv({"t [s]": m.t, "x [mm]": 1e3 * m.x}, sep=";")
)


@shape
def sensor_logger(random: Random) -> File:
    m = decay(random)
    n = _noise(m, random, 0.01)
    columns = {"time": 1.7e18 + 1e9 * m.t, "seconds_elapsed": m.t, "z": n[0], "y": m.a, "x": n[1]}
    text = csv(columns, form="%.12g")
    file = of_decay(m, text, "Accelerometer.csv")
    return asking(file, ("unit",), text.replace(",y,", ",acceleration_y (m/s²),", 1))


@shape
def pixels(random: Random) -> File:
    m = decay(random)
    columns = {"t_s": m.t, "x_px": 640.0 + 1e4 * m.x, "y_px": 360.0 + _noise(m, random, 0.3)[0]}
    text = csv(columns)
    named = csv({"t_s": m.t, "x_m": m.x})
    return asking(of_decay(m, text), ("px",), named)


def _test_machine(head: str, sep: str, scale: float) -> Callable[[Random], File]:
    def made(random: Random) -> File:
        t, x, f, (F, K) = loop(random)
        rows = csv({"t": t, "x": 1e3 * x, "f": scale * f}, sep=sep, head=False)
        return File("test.csv", head + rows, [], {"F_k": F, "K_z": K})

    return made


SHAPES["tensile tester"] = _test_machine("Time,Extension,Load\n(s),(mm),(N)\n", ",", 1.0)
SHAPES["servohydraulic rig"] = _test_machine(
    "MTS793\nStation: 2\n\nTime\tAxial Displacement\tAxial Force\nSec\tmm\tkN\n", "\t", 1e-3
)
_of_loop(
    "loops with a crosshead",
    lambda t, x, f: {"Time (s)": t, "Crosshead (mm)": 1e3 * x, "Load cell (N)": f},
)


def _identified(file: File, folder: Path) -> tuple[str, dict[str, Any]]:
    """Return what the command says of a file, and its document; none where it refuses."""
    content = file.content if isinstance(file.content, bytes) else file.content.encode()
    (folder / file.name).write_bytes(content)
    out, err = io.StringIO(), io.StringIO()
    with contextlib.ExitStack() as stack:
        stack.enter_context(contextlib.redirect_stdout(out))
        stack.enter_context(contextlib.redirect_stderr(err))
        stack.enter_context(warnings.catch_warnings(action="ignore"))
        stack.enter_context(contextlib.suppress(SystemExit))
        main(["identify", str(folder / file.name), *file.arguments, "--json", "-"])
    text = out.getvalue()
    return err.getvalue().replace(f"{folder}/", ""), json.loads(text) if text[:1] == "{" else {}


def _judged(file: File, document: dict[str, Any]) -> str:
    """Return "right", "doubtful", "wrong" or "refused"."""
    if not document:
        return "refused"
    of = document["approaches"].get(document["answer"]) or document.get("maximum_likelihood") or {}
    outcomes = {"right"}
    for symbol, true in file.truth.items():
        if symbol == "f_n":
            fit = document.get("maximum_likelihood") or of
            k = next(
                (document[key] for key in ("k_N_per_m", "k_N_m_per_rad") if key in document), 0
            )
            m = fit.get("m_kg") or fit.get("J_kg_m2")
            off = math.sqrt(k / m) / (2.0 * math.pi) / true - 1.0 if k and m else math.nan
            outcomes.add("right" if abs(off) < _F_N else "wrong" if m else "doubtful")
            continue
        names = {symbol, symbol.replace("F_k", "T_k")}
        value = next((v for key, v in of.items() if key.split("_N")[0] in names), None)
        verdicts = [of["verdicts"][name]["verdict"] for name in names if name in of["verdicts"]]
        if value is None or verdicts != ["usable"]:
            outcomes.add("doubtful")
        elif abs(value / true - 1.0) > WITHIN:
            outcomes.add("wrong")
    return next(one for one in ("wrong", "doubtful", "right") if one in outcomes)


def outcome(run: tuple[str, int]) -> list[dict[str, object]]:
    """Return how a shape fares.   run : its name, and the seed."""
    name, seed = run
    random = np.random.default_rng((_FILES, seed, [*SHAPES].index(name)))
    file = SHAPES[name](random)
    with tempfile.TemporaryDirectory() as folder:
        message, document = _identified(file, Path(folder))
        judged = _judged(file, document)
        says = all(word in message for word in file.named)
        if not file.truth and says:
            judged = "right"
        if judged == "refused" and file.changed and says:
            _, document = _identified(file.changed, Path(folder))
            judged = f"{_judged(file, document)} after one change"
    invented = bool(re.search(_INVENTED, message))
    row = {"shape": name, "outcome": judged, "invented": invented}
    return [row | {"message": " ".join(message.split())[:300]}]


def table(rows: pd.DataFrame) -> str:
    """Return how many files came out how, and those that were not right, in Markdown."""
    counted = [(str(of), str(n)) for of, n in rows["outcome"].value_counts().items()]
    left = rows[~rows["outcome"].str.startswith("right") | rows["invented"]]
    shown = left[["shape", "outcome", "message"]].itertuples(index=False, name=None)
    tables = (
        markdown_table(("outcome", "files"), counted, "lr"),
        markdown_table(("shape", "outcome", "message"), shown),
    )
    return "\n\n".join([*tables, f"Drafts that invent something: {rows['invented'].sum()}"])
