"""What is refused names the key or the option that helps."""

import numpy as np
import pytest

from dampbalance import (
    BaseMotion,
    Oscillator,
    identify,
    measured_orbit,
    measured_ring_down,
    steady_orbit,
)

FORCED = Oscillator(m=2.2, c=40.0, k=3100.0, K_z=190000.0, F_k=1.9)
LOOSE = Oscillator(m=2.2, c=3.0, k=3100.0, K_z=190000.0, F_k=0.8)
HERTZ = 4.5


def forced(**changed):
    """Return a table of a forced record, some columns changed."""
    orbit = steady_orbit(FORCED, BaseMotion(Y=0.0045, omega=2.0 * np.pi * HERTZ))
    of = measured_orbit(orbit, rate_hz=1200.0, cycles=15.0, noise=0.004)
    y, x = of["base_displacement"], of["displacement"]
    columns = {"time_s": y.t, "base_displacement_m": y.values, "displacement_m": x.values}
    return {**columns, **{name: by(columns) for name, by in changed.items()}}


def decay(sign):
    """Return a table of a free decay whose accelerometer may be upside down."""
    channels = "displacement", "acceleration"
    of = measured_ring_down(
        LOOSE, x=0.008, rate_hz=1200.0, duration=2.5, noise=0.001, channels=channels
    )
    x, a = (of[name] for name in channels)
    columns = {"displacement_m": x.values, "acceleration_m_per_s2": sign * a.values}
    return {"time_s": x.t, **columns}


@pytest.mark.parametrize(
    ("table", "options", "named"),
    [
        (forced(), {"frequency": 5.0}, "frequency"),
        (forced(), {"skip_cycles": 14}, "skip.cycles"),
        (forced(), {"kind": "ring-down"}, "kind"),
        # a drive that stands still beside a motion that does not die out
        (forced(base_displacement_m=lambda of: 0.0 * of["time_s"]), {}, "in a mapping"),
        (
            forced(base_displacement_m=lambda of: 0.0 * of["time_s"]),
            {"kind": "forced"},
            "kind",
        ),
        # another sensor, upside down or in g
        (
            forced(
                acceleration_m_per_s2=lambda of: (2.0 * np.pi * HERTZ) ** 2 * of["displacement_m"]
            ),
            {},
            "sign: -1",
        ),
        (
            forced(acceleration_g=lambda of: -((2.0 * np.pi * HERTZ) ** 2) * of["displacement_m"]),
            {},
            "unit: ",
        ),
        (decay(-1.0), {}, "sign: -1"),
    ],
)
def test_refusal_names_what_helps(table, options, named):
    with pytest.raises(ValueError, match=named):
        identify(table, stiffness=FORCED.k, **options)
