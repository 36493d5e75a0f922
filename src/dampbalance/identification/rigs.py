"""Rigs: where the contact of a forced oscillator is held, and which masses move."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, NamedTuple

from ..law.law import Law
from ..law.terms import term
from ..project.wording import Remark, number_text, with_unit
from ..records.measured import MeasuredRecord
from ..signals.mean_harmonics import Reading
from .answer import UNBOUNDED
from .loading import load
from .oscillator import JointFit, joint_fit


class Masses(NamedTuple):
    """Masses of a rig, kg; None where they are not given.

    moving : that the fit sees.   on_base : that stands on a base to which the contact goes.
    """

    moving: float | None
    on_base: float | None


def require_base(records: Sequence[MeasuredRecord], what: str, remedy: str) -> None:
    """Raise ValueError for the first record that a force drives.   what : of the settings needs a base that moves."""
    for record in records:
        if "force" in record.quantities:
            raise ValueError(
                f"{record.name}: a force drives; {what}: {remedy[0].lower()}{remedy[1:]}"
            )


def masses_of(records: Sequence[MeasuredRecord], options: Mapping[str, Any]) -> Masses:
    """Return the masses of a rig from options by the keys of a configuration.

    Where contact and damper of a mount both go to the base, the motion against the base takes the place of x. A load
    cell feels the inertia of what is between it and the mass: f = mẍ + … + m_f ẍ, so that m + m_f moves.

    Raises ValueError for a mount whose mass or stiffness is missing or that a force drives, and for a fixture without a
    load cell.
    """
    mass, fixture = options["mass_kg"], options["fixture_mass_kg"]
    if options["contact_to"] == "base":
        if None in (options["stiffness_N_per_m"], mass):
            raise ValueError(
                "contact_to = base needs stiffness and mass, as a mount moves as under the force −mÿ: weigh what "
                "stands on it (--mass)"
            )
        at_rest = "contact_to = base is for a base that moves"
        require_base(records, at_rest, "leave it out, as ground and base are at rest alike")
    if fixture is not None:
        for record in records:
            if "force" not in record.quantities:
                raise ValueError(
                    f"{record.name}: fixture_mass is what a load cell carries besides the mass, and the record has no "
                    "force: leave it out"
                )
    moving = mass + (fixture or 0.0) if mass is not None else None
    return Masses(moving, mass if options["contact_to"] == "base" else None)


def require_possible(readings: Sequence[Reading], mass: float | None, k: float) -> None:
    """Raise ValueError for a mass with which the oscillator is a thousand times faster or slower than the drive."""
    if mass is None:
        return
    for reading in readings:
        swings = math.sqrt(k / mass) / reading.steady.omega
        if not 1e-3 < swings < 1e3:  # beyond that a unit is wrong
            raise ValueError(
                f"with k = {k:g} N/m and m = {mass:g} kg the oscillator swings {swings:.2g} times in a cycle of "
                f"{reading.steady.source}: give the mass in kg and the stiffness in N/m, or leave out the mass"
            )


def of_a_mount(
    joint: JointFit,
    records: Sequence[MeasuredRecord],
    k: float,
    masses: Masses,
    law: Law,
    of_drive: Mapping[str, Any],
) -> Iterator[Remark]:
    """Yield a sentence where the records are those of a mount within their noise, and not of a contact to the ground.

    joint : the fit with the contact to the ground.   k : N/m.   of_drive : options of `load`.
    """
    sure = joint.waveforms_hold and not joint.explained
    driven = any("force" in record.quantities for record in records)
    if sure or driven or masses.moving is None or masses.on_base is not None:
        return
    try:
        readings = [load(record, k, base_mass=masses.moving, **of_drive) for record in records]
    except ValueError:  # a mass with which nothing moves like this
        return
    lines = [reading.lines for reading in readings]
    other = joint_fit(lines, k, masses.moving, law, departures=False)
    if other.waveforms_hold and other.mass_fits and other.fit is not None:
        values = ", ".join(
            with_unit(f"{key} = {number_text(other.fit.value(key), 3)}", term(key).unit)
            for key in law.unknowns
        )
        yield Remark(
            f"a mount, whose friction acts between base and mass, explains the records within their noise ({values}): "
            "if yours is one, give contact_to=base (--contact-to base)",
            doubts=UNBOUNDED,
        )
