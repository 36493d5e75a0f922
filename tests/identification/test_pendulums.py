"""Pendulums of large angles: the numbers of an independent integrator, with the option and without."""

from __future__ import annotations

import math

import numpy as np
import pytest

from dampbalance import identify
from dampbalance.fit.select import REFITTED
from dampbalance.identification.answer import USABLE
from dampbalance.identification.decays import identify_decay_records
from dampbalance.measured import read_records
from identification.pendulums import Release
from identification.releases import FAR


def identified(release, seed=1, **options):
    return identify(release.record(seed), release.k, kind="ring-down", **options)


def off(found, release):
    """Differences of T_k and c from the truth in standard errors."""
    return [
        (found.values[s] - getattr(release, s)) / found.standard_errors[s] for s in ("F_k", "c")
    ]


@pytest.mark.parametrize(("A", "option"), [(0.3, False), (1.3, False), (2.0, True)])
def test_friction_and_damping_are_those_of_an_independent_integrator(A, option):
    release = Release(A)
    found = identified(release, pendulum=option)
    assert found.basis.fit.problem.pendulum
    assert np.abs(off(found, release)).max() < FAR
    assert found.verdicts["F_k"].verdict == found.verdicts["c"].verdict == USABLE
    assert found.basis.fit.error("F_k") < 0.01 * release.F_k
    # the balance agrees, from swings that are not those of a spring
    for symbol in ("F_k", "c"):
        assert found.approaches["balance"].values[symbol] == pytest.approx(
            getattr(release, symbol), rel=0.1
        )
    said = {one.code for one in found.findings}
    assert ("pendulum" in said) != option
    assert "contradicts" not in said
    assert max(one.weight for one in found.weighed if one.name == "k_3") < REFITTED


def without_friction(count, seed):
    """Return how many releases have a T_k that is not there, and how many a c that the interval misses."""
    random, wrong, missed = np.random.default_rng(seed), 0, 0
    for i in range(count):
        release = Release(random.uniform(0.5, 0.8), 0.0, random.uniform(1e-3, 3e-3))
        found = identified(release, seed + i)
        verdict = found.verdicts["F_k"]
        wrong += verdict.verdict == USABLE and math.isfinite(verdict.within)
        low, high = found.intervals["c"]
        missed += not low <= release.c <= high
    return wrong, missed


def test_a_pendulum_without_friction_shows_none():
    assert without_friction(1, 4) == (0, 0)


def test_of_18_pendulums_without_friction_none_shows_any():
    wrong, missed = without_friction(18, 50)
    assert wrong == 0
    assert missed <= 3  # of 18 with 5 % each, 1.1 % of the time by chance


def test_a_spring_that_does_not_soften_is_none():
    release = Release(0.6, spring=True)
    found = identified(release)
    assert not found.basis.fit.problem.pendulum
    assert np.abs(off(found, release)).max() < FAR


def test_what_does_not_rotate_is_no_pendulum():
    record = Release(0.6, spring=True).record(1)
    record["displacement_m"] = record.pop("angle_rad")
    with pytest.raises(ValueError, match="pendulum"):
        identify(record, 1.5, kind="ring-down", pendulum=True)


def test_no_law_is_supported_whose_residual_the_fit_itself_rejects():
    """A spring with friction and damping for a pendulum: its residual is a motion, whatever the terms."""
    release = Release(1.0)
    (record,) = read_records(release.record(1), free=True)
    found = identify_decay_records([record], release.k, laws=True)
    assert "weighs" in {one.code for one in found.findings}
    assert found.laws.chosen is None
