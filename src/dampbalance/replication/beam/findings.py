"""What the stepped-sine lines of a bolted beam say of its joint, and whether they foretell the decay after a blow.

The lines are those of one mode at several levels; the laws are those of `likelihood.dynamic_stiffness`. The decay is
an independent witness: another test, another day, no shaker. Of a mode that loses W(X) in a cycle the equivalent
damping ratio at the amplitude X is

    ζ(X) = W(X)/(2π m ω² X²)

from the fit to the lines, and from the slope of the decay's envelope (`hammer.py`).
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...arrays import Array, Integers
from ...identification.stepped_sine import SteppedOutcome
from ...law.terms import FRICTION
from ...likelihood.dynamic_stiffness import (
    Band,
    ContactComparison,
    ContactFit,
    SteppedLines,
    fit_contact,
)
from ...records.measured import read_records
from .hammer import ModalDecay, filter_bias, modal_decay

ADDITIONS = ("residual", "hardening")
"""Options of a fit whose worth is shown by leaving each of them out."""

_NEAR = 0.8  # sin φ of lines near the resonance
_SHOWN = 6  # amplitudes of the decay in the table


@dataclass(frozen=True, eq=False)
class Findings:
    """The results for the beam.

    document : every number, for JSON.   lines : of the tables.   fits : of each law by its name.
    decays : after the blow, by the channel.   foretold : damping ratio that the lines foretell at the first decay's
    amplitudes within their range, with its band.
    """

    document: dict[str, Any]
    lines: SteppedLines
    fits: Mapping[str, ContactFit]
    decays: Mapping[str, ModalDecay]
    foretold: Band


def findings_of(identified: SteppedOutcome, beam: Mapping[str, Any]) -> Findings:
    """All results for the beam, from the identification of its tables.

    beam : as for `findings`. Raises ValueError as `findings` does, and for too few levels to compare contacts.
    """
    if identified.compared is None:
        raise ValueError(
            "beam: contacts are compared by levels that are left out, of three or more"
        )
    options = identified.options
    asked: dict[str, Any] = {
        "terms": [symbol for symbol in options["terms"] if symbol != FRICTION],
        "given": options["given"],
        "stiffness": options["stiffness_N_per_m"],
        "mass": options["mass_kg"],
        **{name: options[name] for name in ADDITIONS},
    }
    without = {
        name: fit_contact(identified.lines, contact="gradual", **asked | {name: False})
        for name in ADDITIONS
        if options[name]
    }
    return findings(identified.compared, identified.lines, without, beam)


def findings(
    comparison: ContactComparison,
    lines: SteppedLines,
    without: Mapping[str, ContactFit],
    beam: Mapping[str, Any],
) -> Findings:
    """All results for the beam.

    comparison : of the contacts that the lines may come from.   lines : of the tables.   without : fits of the gradual
    contact without one of ADDITIONS, by its name.   beam : the section of that name in the configuration: record,
    channels, time, unit, band_hz, start_s and window_s of a blow.

    Raises ValueError where a record cannot be read, and where the decay passes no amplitude of the lines.
    """
    fits = {trial.name: trial.fit for trial in comparison.trials}
    gradual = fits["gradual"]
    decays, bias = _decays(beam)
    first, point = next(iter(decays.items()))
    inside = np.flatnonzero((gradual.X_range[0] < point.X) & (gradual.X_range[1] > point.X))
    if not inside.size:
        low, high = (1e6 * X for X in gradual.X_range)
        raise ValueError(
            f"beam: the decay of {first} passes no amplitude of the lines, {low:.3g} to {high:.3g} µm: name another "
            "channel first, or an earlier start_s"
        )
    foretold = _damping_ratio(gradual, point.X[inside], point.frequency_hz[inside])
    off = foretold.value / point.zeta[inside] - 1.0
    shown = np.unique(np.linspace(0, inside.size - 1, _SHOWN).round().astype(int))
    document = {
        "levels": [_level(lines, i) for i in range(len(lines.names))],
        "laws": [
            {
                "law": trial.name,
                **_misfits(trial.fit, lines),
                "held_out_loss": [one.loss for one in trial.held_out],
                "held_out_in_phase_N_per_m": [one.in_phase for one in trial.held_out],
                "upper_from_lower": trial.extrapolated.loss,
            }
            for trial in comparison.trials
        ],
        "supported": comparison.supported,
        "words": comparison.words(),
        "without": {name: _misfits(fit, lines) for name, fit in without.items()},
        "gradual": {
            name: {"value": value, "interval": gradual.intervals.get(name)}
            for name, value in (*gradual.values.items(), ("K_z", gradual.K_z), ("F_k", gradual.F_k))
        },
        "X_range_m": gradual.X_range,
        "blow": {
            "channels": list(decays),
            "amplitudes": [
                {
                    "t_s": point.t[inside[i]],
                    "X_m": point.X[inside[i]],
                    "frequency_hz": point.frequency_hz[inside[i]],
                    "zeta": [one.zeta[inside[i]] for one in decays.values()],
                    "foretold": [part[i] for part in foretold],
                }
                for i in shown
            ],
            "off_mean": float(np.mean(off)),
            "off_worst": float(off[np.argmax(np.abs(off))]),
            "filter_bias": float(np.abs(bias[inside]).max()),
            "scale": _scale(gradual, point, inside),
        },
    }
    return Findings(document, lines, fits, decays, foretold)


def _decays(beam: Mapping[str, Any]) -> tuple[dict[str, ModalDecay], Array]:
    """The decay in each channel, and the filter's bias of the first."""
    steps = {"start": beam["start_s"], "window": beam["window_s"]}
    band, decays, bias = tuple(beam["band_hz"]), {}, None
    for name in beam["channels"]:
        channel = {"acceleration": {"channel": name, "unit": beam["unit"]}}
        mapping = {"channels": channel, "time": {"channel": beam["time"], "unit": "s"}}
        (record,) = read_records(beam["record"], mapping=mapping)
        measured = record.whole()["acceleration"]
        try:
            decays[name] = modal_decay(measured.t, measured.values, band, **steps)
        except ValueError as error:
            raise ValueError(f"beam: {beam['record']}: {error}") from None
        bias = filter_bias(decays[name], measured.t, band, **steps) if bias is None else bias
    assert bias is not None
    return decays, bias


def _damping_ratio(fit: ContactFit, X: Array, frequency_hz: Array) -> Band:
    """ζ(X) of a fit, with its band."""
    omega = 2.0 * math.pi * frequency_hz
    size = 2.0 * math.pi * fit.values["m"] * omega**2 * X**2
    return Band(*(part / size for part in fit.loss(X, omega)))


def _scale(fit: ContactFit, decay: ModalDecay, inside: Integers) -> float:
    """Factor on the amplitudes of the decay with which the lines foretell its damping best: 1 where its channel
    is the driven point, and the joint the same."""

    def off(scale: float) -> float:
        X = np.clip(scale * decay.X[inside], *fit.X_range)
        foretold = _damping_ratio(fit, X, decay.frequency_hz[inside]).value
        return float(np.mean(np.log(foretold / decay.zeta[inside]) ** 2))

    return float(min(np.geomspace(0.5, 2.0, 281), key=off))


def _level(lines: SteppedLines, number: int) -> dict[str, Any]:
    """Lines of a level, its amplitudes, and the frequency at which its in-phase part vanishes."""
    of = lines[lines.level == number]
    order = np.argsort(of.omega)
    hertz, in_phase = of.omega[order] / (2.0 * math.pi), of.Z.real[order]
    turns = np.flatnonzero((in_phase[:-1] > 0.0) & (in_phase[1:] <= 0.0))
    resonance = math.nan
    if turns.size:
        at = slice(turns[0], turns[0] + 2)
        resonance = float(np.interp(0.0, -in_phase[at], hertz[at]))
    return {
        "level": lines.names[number],
        "lines": of.X.size,
        "X_m": [float(of.X.min()), float(of.X.max())],
        "frequency_hz": [float(hertz[0]), float(hertz[-1])],
        "resonance_hz": resonance,
    }


def _misfits(fit: ContactFit, lines: SteppedLines) -> dict[str, Any]:
    """How far the lines lie from a law."""
    near = np.sin(np.angle(lines.Z)) > _NEAR
    return {
        "loss": fit.misfit.loss,
        "loss_near_resonance": float(np.sqrt(np.mean(fit.residuals.imag[near] ** 2))),
        "in_phase_N_per_m": fit.misfit.in_phase,
    }
