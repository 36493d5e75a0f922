"""What the interface gives can be copied and pickled, and is the same afterwards."""

from __future__ import annotations

import copy
import math
import pickle
from dataclasses import replace

import numpy as np
import pytest

from dampbalance import (
    BaseMotion,
    identify,
    measured_orbit,
    measured_ring_down,
    read_records,
    steady_orbit,
    steady_orbits,
)
from dampbalance.features import of_orbit
from dampbalance.motion.law_response import law_response
from paper_case import PAPER

MOTION = BaseMotion(Y=0.004, omega=2.0 * math.pi * 3.5)
COPIES = {
    "copy": copy.copy,
    "deepcopy": copy.deepcopy,
    "pickle": lambda thing: pickle.loads(pickle.dumps(thing)),
}


def made(Y):
    orbit = steady_orbit(PAPER, BaseMotion(Y, MOTION.omega))
    return measured_orbit(orbit, rate_hz=500.0, cycles=12.0, noise=0.003)


def of_law():
    orbit = law_response(PAPER, MOTION, {"c_2": 20.0})
    orbit.state(0.1)  # what it keeps from then on is copied, too
    return orbit


def features():
    return replace(of_orbit(steady_orbit(PAPER, MOTION)), integrals={"c_2": np.array([1.5])})


# what is made, and all that it says
THINGS = {
    "orbit": (lambda: steady_orbit(PAPER, MOTION), lambda o: (o.to_dict(), o.W, o.state(0.1))),
    "orbits": (lambda: steady_orbits(PAPER, Y=[0.004, 0.008], omega=22.0), lambda o: o.X.tolist()),
    "orbit of a law": (of_law, lambda o: (o.state(0.2), o.X)),
    "features": (features, lambda f: (f.to_frame().to_csv(), dict(f.integrals))),
    "measurement": (lambda: made(0.004), lambda m: {q: m[q].values.tobytes() for q in m}),
    "record": (lambda: read_records(made(0.004))[0], lambda r: (repr(r), r.to_frame().to_csv())),
    "forced": (
        lambda: identify([made(0.004), made(0.012)], PAPER.k, laws=True),
        lambda found: (found.document(), found.text(), found.to_frame().to_csv()),
    ),
    "decay": (
        lambda: identify(measured_ring_down(PAPER, x=0.05, rate_hz=500.0, duration=0.8), PAPER.k),
        lambda found: (found.document(), found.text()),
    ),
}


@pytest.mark.parametrize(("make", "say"), THINGS.values(), ids=THINGS)
def test_a_copy_says_the_same(make, say):
    original = make()
    said = repr(say(original))
    for way, copied in COPIES.items():
        other = copied(original)
        assert type(other) is type(original), way
        assert repr(say(other)) == said, way
    assert repr(say(original)) == said
