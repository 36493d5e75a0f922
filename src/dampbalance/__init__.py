"""Friction and viscous damping of a vibrating system, identified from records of its motion.

The energy balance and the oscillator with a compliant contact are those of Liang & Feeny, *Balancing energy to estimate
damping in a forced oscillator with compliant contact*, DETC2010-28049.
"""

# True for type checkers, which know the name; `typing` takes long to import, and Ctrl-C is not caught here
TYPE_CHECKING = False
if TYPE_CHECKING:
    from .balance import Rows
    from .features import Features
    from .identification.answer import Answer, Interval, ParameterEstimate, Verdict
    from .identification.decays import identify_decays
    from .identification.forced import friction_loops, identify_forced
    from .identification.friction_speed import identify_friction_speed
    from .identification.loops import (
        friction_coefficient,
        identify_loops,
        loop_contact,
        loop_history,
        loop_sliders,
    )
    from .identification.result import Result
    from .identification.stepped_sine import damping_at
    from .measured import identify, identify_joint, read_records
    from .model import BaseMotion, NoOscillator, Oscillator
    from .motion.orbit import NoSteadyOrbit, Orbit, steady_orbit
    from .motion.orbits import Orbits, steady_orbits
    from .motion.regime import Regime
    from .motion.sliders import SlidersOrbit, sliders_orbit
    from .motion.states import State
    from .motion.transient import Trajectory, transient
    from .project.documents import ConfigurationError
    from .records.channel import Channel
    from .records.errors import RecordError
    from .records.record import Record
    from .records.synthetic import measured_orbit, measured_ring_down
    from .studies.study import StudyResult, study

__version__ = "1.0.0"

__all__ = [
    "Answer",
    "BaseMotion",
    "Channel",
    "ConfigurationError",
    "Features",
    "Interval",
    "NoOscillator",
    "NoSteadyOrbit",
    "Orbit",
    "Orbits",
    "Oscillator",
    "ParameterEstimate",
    "Record",
    "RecordError",
    "Regime",
    "Result",
    "Rows",
    "SlidersOrbit",
    "State",
    "StudyResult",
    "Trajectory",
    "Verdict",
    "damping_at",
    "friction_coefficient",
    "friction_loops",
    "identify",
    "identify_decays",
    "identify_forced",
    "identify_friction_speed",
    "identify_joint",
    "identify_loops",
    "loop_contact",
    "loop_history",
    "loop_sliders",
    "measured_orbit",
    "measured_ring_down",
    "read_records",
    "sliders_orbit",
    "steady_orbit",
    "steady_orbits",
    "study",
    "transient",
]

# Each is imported when it is first used, so that the command line starts without NumPy.
_MODULES = {
    "balance": ("Rows",),
    "features": ("Features",),
    "identification.answer": ("Answer", "Interval", "ParameterEstimate", "Verdict"),
    "identification.decays": ("identify_decays",),
    "identification.forced": ("friction_loops", "identify_forced"),
    "identification.loops": (
        *("friction_coefficient", "identify_loops"),
        *("loop_contact", "loop_history", "loop_sliders"),
    ),
    "identification.friction_speed": ("identify_friction_speed",),
    "identification.result": ("Result",),
    "identification.stepped_sine": ("damping_at",),
    "measured": ("identify", "identify_joint", "read_records"),
    "model": ("BaseMotion", "NoOscillator", "Oscillator"),
    "motion.orbit": ("NoSteadyOrbit", "Orbit", "steady_orbit"),
    "motion.orbits": ("Orbits", "steady_orbits"),
    "motion.regime": ("Regime",),
    "motion.sliders": ("SlidersOrbit", "sliders_orbit"),
    "motion.states": ("State",),
    "motion.transient": ("Trajectory", "transient"),
    "project.documents": ("ConfigurationError",),
    "records.channel": ("Channel",),
    "records.errors": ("RecordError",),
    "records.record": ("Record",),
    "records.synthetic": ("measured_orbit", "measured_ring_down"),
    "studies.study": ("StudyResult", "study"),
}


def __getattr__(name: str) -> object:
    from importlib import import_module

    for module, names in _MODULES.items():
        if name in names:
            item = getattr(import_module(f".{module}", __name__), name)
            globals()[name] = item
            return item
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted(["__version__", *__all__])
