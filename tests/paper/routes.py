"""The exact and the as-published route of `config/config.yaml`, computed in memory, for any oscillator."""

from __future__ import annotations

import math
from functools import lru_cache
from pathlib import Path

import yaml

from dampbalance.balance import APPROACHES_OF_TABLE_3
from dampbalance.estimates import estimate_table
from dampbalance.features import of_orbit, stack
from dampbalance.model import BaseMotion, Oscillator
from dampbalance.motion.fixed_step import simulate
from dampbalance.motion.orbit import steady_orbit
from dampbalance.project.case import oscillator_from, pairs_from
from dampbalance.reading.clean import of_record
from dampbalance.replication.claims import RouteTables, Setting
from dampbalance.replication.readout import ReadOut

ROOT = Path(__file__).parents[2]
PUBLISHED = ROOT / "paper/published"
CONFIG = yaml.safe_load((ROOT / "config/config.yaml").read_text(encoding="utf-8"))
NUMERICS = CONFIG["as_published"]
PAPER = oscillator_from(CONFIG["oscillator"])
FREQUENCIES_HZ = {drive["name"]: drive["hz"] for drive in CONFIG["excitation"]["frequencies"]}
LEVELS = tuple(CONFIG["excitation"]["levels_m"])
PAIRS = pairs_from(CONFIG["estimation"]["pairs"])


def setting(oscillator: Oscillator = PAPER) -> Setting:
    """What the configuration holds when its oscillator is this one."""
    return Setting(
        oscillator=oscillator,
        frequencies_hz=FREQUENCIES_HZ,
        levels_m=LEVELS,
        scheme=NUMERICS["scheme"],
        step_s=NUMERICS["step_s"],
        k_over_m=_coefficients(oscillator)["k_over_m"],
    )


@lru_cache
def exact(oscillator: Oscillator = PAPER) -> RouteTables:
    """The exact route at the three frequencies."""
    features = {
        name: stack([of_orbit(steady_orbit(oscillator, motion)) for motion in _motions(name)])
        for name in FREQUENCIES_HZ
    }
    return RouteTables(
        {name: of.to_frame() for name, of in features.items()},
        {name: estimate_table(of, oscillator.k, PAIRS) for name, of in features.items()},
    )


@lru_cache
def as_published(oscillator: Oscillator = PAPER) -> RouteTables:
    """The as-published route: integrals taken at samples, the rest between them and read out."""
    tabulated, two_point = (
        ReadOut.from_config(NUMERICS[name]) for name in ("tabulated", "two_point")
    )
    features, estimates = {}, {}
    for name, hz in FREQUENCIES_HZ.items():
        records = [
            simulate(
                oscillator,
                motion,
                scheme=NUMERICS["scheme"],
                step=NUMERICS["step_s"],
                cycles=NUMERICS["cycles"],
                keep_cycles=3,
                **_coefficients(oscillator),
            )
            for motion in _motions(name)
        ]
        sampled, between = (
            stack([of_record(r, 2.0 * math.pi * hz, oscillator.k, reading) for r in records])
            for reading in ("sample", "interpolated")
        )
        read = tabulated.apply(between).replaced(a=sampled.a, b=sampled.b, W=sampled.W)
        features[name] = read.to_frame()
        estimates[name] = estimate_table(
            read,
            oscillator.k,
            PAIRS,
            common=two_point.common(between),
            common_approaches=APPROACHES_OF_TABLE_3,
        )
    return RouteTables(features, estimates)


def _motions(frequency: str) -> list[BaseMotion]:
    return [BaseMotion(Y=Y, omega=2.0 * math.pi * FREQUENCIES_HZ[frequency]) for Y in LEVELS]


def _coefficients(oscillator: Oscillator) -> dict[str, float]:
    """c/m and k/m with the digits that the paper's program kept."""
    return {
        "c_over_m": round(oscillator.c / oscillator.m, NUMERICS["c_over_m_decimals"]),
        "k_over_m": round(oscillator.k / oscillator.m, NUMERICS["k_over_m_decimals"]),
    }
