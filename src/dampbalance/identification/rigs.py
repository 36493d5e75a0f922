"""Rigs: where the contact of a forced oscillator is held, and which masses move."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, NamedTuple

from ..findings.finding import UNBOUNDED, Finding
from ..findings.words import sentence
from ..law.law import Law
from ..project.spelling import spelled
from ..records.coordinate import ROTATION, Coordinate
from ..records.record import Record
from ..signals.mean_harmonics import Reading
from .loading import load
from .oscillator import CommonFit, common_fit


class Masses(NamedTuple):
    """Masses of a rig, kg; None where they are not given.

    moving : the mass that the fit determines.   on_base : a mass on a mount, whose contact acts against the base.
    """

    moving: float | None
    on_base: float | None


def require_driven_by(base: bool, records: Sequence[Record], code: str) -> None:
    """Raise ValueError for the first record that is not driven by a moving base (`base`), or by a force.   code : of
    the finding that says why that is needed."""
    for record in records:
        if base == ("force" in record.quantities):
            raise ValueError(f"{record.name}: {sentence(Finding(code), record.coordinate)}")


def require_rotation(records: Sequence[Record]) -> None:
    """Raise ValueError for the first record that does not rotate, and so is none of a pendulum."""
    for record in records:
        if record.coordinate != ROTATION:
            why = sentence(Finding("no angle"), record.coordinate)
            raise ValueError(f"{record.name}: {why}")


def masses_of(records: Sequence[Record], options: Mapping[str, Any]) -> Masses:
    """Return the masses of a rig from options by the keys of a configuration.

    Contact and damper of a mount both act against the base, so that the motion relative to it takes the place of x. A
    load cell also carries the inertia of a fixture between it and the mass: f = mẍ + … + m_f ẍ, so that m + m_f moves.

    Raises ValueError for a mount whose mass or stiffness is missing or that is driven by a force, and for a fixture
    without a load cell.
    """
    mass, fixture = options["mass_kg"], options["fixture_mass_kg"]
    if options["contact_to"] == "base":
        if None in (options["stiffness_N_per_m"], mass):
            raise ValueError(
                "contact_to = base needs stiffness and mass, as a mount moves as under the force −mÿ: weigh what "
                f"stands on it ({spelled('mass')})"
            )
        require_driven_by(True, records, "no base")
    if fixture is not None:
        require_driven_by(False, records, "no load cell")
    moving = mass + (fixture or 0.0) if mass is not None else None
    return Masses(moving, mass if options["contact_to"] == "base" else None)


def require_possible(
    readings: Sequence[Reading], mass: float | None, k: float, coordinate: Coordinate
) -> None:
    """Raise ValueError for a mass with which the natural frequency is a thousand times that of the drive, or a
    thousandth."""
    if mass is None:
        return
    for reading in readings:
        swings = math.sqrt(k / mass) / reading.steady.omega
        if not 1e-3 < swings < 1e3:  # beyond that a unit is wrong
            why = Finding("impossible", {"k": k, "given": mass, "swings": swings})
            raise ValueError(f"{reading.steady.source}: {sentence(why, coordinate)}")


def of_a_mount(
    common: CommonFit,
    records: Sequence[Record],
    k: float,
    masses: Masses,
    law: Law,
    of_drive: Mapping[str, Any],
) -> Iterator[Finding]:
    """Yield a finding if a mount explains the records within their noise, and a contact to the ground does not.

    common : the fit with the contact to the ground.   k : N/m.   of_drive : options of `load`.
    """
    sure = common.waveforms_hold and not common.clear
    driven = any("force" in record.quantities for record in records)
    if sure or driven or masses.moving is None or masses.on_base is not None:
        return
    try:
        readings = [load(record, k, base_mass=masses.moving, **of_drive) for record in records]
    except ValueError:  # no motion with this mass
        return
    lines = [reading.lines for reading in readings]
    other = common_fit(lines, k, masses.moving, law, departures=False)
    if other.waveforms_hold and other.mass_fits and other.fit is not None:
        values = tuple((key, other.fit.value(key)) for key in law.unknowns)
        yield Finding("mount", {"values": values}, UNBOUNDED)
