"""Identify the joint of a bolted beam from stepped-sine tables, and predict the decay after a blow.

Run it as `python beam.py DATA RESULTS`, two folders.

The tables hold steady responses of the first bending mode at twelve levels of excitation. The decay is an independent
witness: another test, another day, no shaker. A band-pass filter leaves the mode, whose analytic signal A e^{iψ}
(Hilbert's transform) gives in windows of a few cycles

    X = A/ω²,   ω = ψ̇,   ζ = −(d ln A/dt)/ω

(Feldman, Mech. Syst. Signal Process. 25 (2011)).
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import jinja2
import matplotlib.pyplot as plt
import numpy as np
import pandas as pd
from scipy import signal

from dampbalance import Result, damping_at, identify, read_records

TABLES, BLOW = "ForcedFrequencyResponses.mat", "HammerImpact.mat"
COLUMNS = {
    "frequency": {"channel": "frequency", "unit": "Hz"},
    "force": {"channel": "force", "unit": "N"},
    "acceleration": {"channel": "amplitude", "unit": "m/s^2"},
    "phase": {"channel": "phase", "unit": "rad"},
}
CHANNELS = ("acc1", "acc2", "acc3")  # the first is compared with the tables
BAND = (60.0, 110.0)  # Hz: holds the first bending mode, and no other
START = 0.25  # s: by then the filter has forgotten the blow, to 0.3 % of the damping
WINDOW = 0.2  # s: 16 cycles, in which the amplitude falls by 20 % at most
SHOWN = 6  # amplitudes in the table
ADDITIONS = {"residual": "residual receptance", "hardening": "hardening"}


def identified(folder: Path, **changed: Any) -> Result[Any]:
    """Identify the contact from the tables; other modes, the rigid ones among them, move the driven point, too."""
    options = {"kind": "stepped-sine", "residual": True, **changed}
    return identify(folder / TABLES, mapping={"table": COLUMNS}, **options)


def modal_decay(t: np.ndarray, acceleration: np.ndarray) -> pd.DataFrame:
    """Return amplitude X_m, frequency_hz and damping ratio zeta of the mode at the middles of windows, t_s.

    t : s, evenly spaced, (n,), at the blow 0.   acceleration : m/s², (n,).
    """
    rate = (t.size - 1) / (t[-1] - t[0])
    passed = signal.butter(4, BAND, "bandpass", fs=rate, output="sos")
    analytic = signal.hilbert(signal.sosfiltfilt(passed, acceleration))
    log, phase = np.log(np.abs(analytic)), np.unwrap(np.angle(analytic))
    length, first = round(WINDOW * rate), int(np.searchsorted(t, START))
    # without the last window, where the filter runs out
    windows = (t.size - first) // length - 1
    parts = np.arange(first, first + windows * length).reshape(windows, length)
    step = (np.arange(length) - 0.5 * (length - 1)) / rate
    slope, omega = (of[parts] @ step / (step @ step) for of in (log, phase))
    return pd.DataFrame(
        {
            "t_s": t[parts].mean(axis=1),
            "X_m": np.exp(log[parts].mean(axis=1)) / omega**2,
            "frequency_hz": omega / (2.0 * np.pi),
            "zeta": -slope / omega,
        }
    )


def decays_in(folder: Path) -> dict[str, pd.DataFrame]:
    """Return the decay after the blow by channel."""
    decays = {}
    for name in CHANNELS:
        channel = {"acceleration": {"channel": name, "unit": "m/s^2"}}
        mapping = {"channels": channel, "time": {"channel": "time", "unit": "s"}}
        (record,) = read_records(folder / BLOW, mapping=mapping)
        frame = record.to_frame()
        decays[name] = modal_decay(
            frame.index.to_numpy(), frame["acceleration_m_per_s2"].to_numpy()
        )
    return decays


def predicted(answer: Result[Any], decay: pd.DataFrame) -> pd.DataFrame:
    """Return the windows at amplitudes of the tables, with the damping_ratio that these imply, its low and high."""
    implied = damping_at(answer, decay["X_m"], decay["frequency_hz"]).drop(columns="X_m")
    return decay.join(implied).dropna(ignore_index=True)


def best_factor(answer: Result[Any], windows: pd.DataFrame) -> float:
    """Return the factor on the amplitudes of the decay with which the tables predict its damping best.

    It is 1 where the channel is at the driven point and the joint has stayed the same.
    """

    def off(factor: float) -> float:
        scaled = windows.assign(X_m=factor * windows["X_m"])[["X_m", "frequency_hz", "zeta"]]
        of = predicted(answer, scaled)
        return float(np.mean(np.log(of["damping_ratio"] / of["zeta"]) ** 2))

    return float(min(np.linspace(0.5, 2.0, 151), key=off))


def results_of(
    answer: Result[Any], fewer: dict[str, Result[Any]], decays: dict[str, pd.DataFrame]
) -> dict[str, Any]:
    """Return all numbers of the page.   fewer : identifications without an addition, by its name."""
    document, first = answer.document(), decays[CHANNELS[0]]
    windows = predicted(answer, first)
    off = windows["damping_ratio"] / windows["zeta"] - 1.0
    shown = np.unique(np.linspace(0, len(windows) - 1, SHOWN).round().astype(int))
    return {
        "supported": document["comparison"]["supported"],
        "weights": {one["name"]: one["weight"] for one in document["weights"]},
        "fits": {
            name: {key: of.answer.merit[key] for key in ("loss_rms", "in_phase_rms_N_per_m")}
            for name, of in {"nothing": answer, **fewer}.items()
        },
        "numbers": {
            row.symbol: {"unit": row.unit, "value": row.value, "interval": [row.low, row.high]}
            for row in answer.to_frame().itertuples()
            if row.approach == document["comparison"]["supported"]
        },
        "windows": windows.loc[shown].to_dict("records"),
        "off_mean": float(off.mean()),
        "off_worst": float(max(off, key=abs)),
        "rig": answer.in_sentences(answer.rig),
        "best_factor": best_factor(answer, first),
        "limits": answer.in_sentences(answer.findings),
    }


def draw(answer: Result[Any], decays: dict[str, pd.DataFrame], file: Path) -> None:
    """Draw the damping ratio of the decay against its amplitude, and as the tables predict it."""
    plt.rcParams["svg.hashsalt"] = "beam"  # the same bytes each time
    figure, axes = plt.subplots(figsize=(5.0, 3.5), layout="constrained")
    windows = predicted(answer, decays[CHANNELS[0]])
    for marker, (name, decay) in zip("os^", decays.items(), strict=True):
        # at the amplitude of the first channel: all of them belong to one mode
        zeta = np.interp(windows["t_s"], decay["t_s"], decay["zeta"])
        axes.plot(1e6 * windows["X_m"], 1e3 * zeta, marker, mfc="none", ms=4.0, label=name)
    X, low, high = (windows[name] for name in ("X_m", "low", "high"))
    axes.plot(1e6 * X, 1e3 * windows["damping_ratio"], "k", label="predicted from the tables")
    axes.fill_between(1e6 * X, 1e3 * low, 1e3 * high, color="k", alpha=0.2, lw=0.0)
    axes.set(xlabel="$X$ (µm)", ylabel=r"$\zeta$ (‰)")
    axes.legend()
    figure.savefig(file, metadata={"Date": None})
    plt.close(figure)


def main(data: Path, results: Path) -> None:
    """Write page, numbers and pictures."""
    answer, decays = identified(data), decays_in(data)
    fewer = {
        words: identified(data, contact="gradual", **{o: False}) for o, words in ADDITIONS.items()
    }
    answer.save(results / "identification", overwrite=True)
    numbers = results_of(answer, fewer, decays)
    draw(answer, decays, results / "beam.svg")
    (results / "beam.json").write_text(json.dumps(numbers, indent=1) + "\n", encoding="utf-8")
    template = Path(__file__).with_name("beam.md.j2").read_text(encoding="utf-8")
    environment = jinja2.Environment(
        trim_blocks=True, lstrip_blocks=True, keep_trailing_newline=True
    )
    (results / "beam.md").write_text(
        environment.from_string(template).render(**numbers), encoding="utf-8"
    )


if __name__ == "__main__":
    main(*map(Path, sys.argv[1:]))
