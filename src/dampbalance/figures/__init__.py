"""The figures of the paper, and one it lacks: from orbits and tables of estimates to pictures.

`looks.py` says how each approach looks, `style.py` how everything does. Each function is pure and returns a matplotlib
`Figure`; `save` writes it as SVG and PNG. `ALT` says in a sentence what each shows in the paper's case, for readers
who cannot see it.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .cycle import figure3, friction_velocity_loop
    from .error_levels import estimation_error
    from .schematic import schematic
    from .style import save

ALT = {
    "figure1": (
        "Mass m on rollers, driven through a spring k by a base that moves by y(t), damped by c against the ground, "
        "and held by a contact spring K_z in series with a Coulomb slider F_k."
    ),
    "figure2": (
        "Friction force against velocity over a steady cycle: flat at plus and minus F_k in slip, joined near zero "
        "velocity by two curved microstick branches, from C up to D and from A down to B."
    ),
    "figure3": (
        "Acceleration against displacement and against velocity at all excitation levels, and enlarged for one: the "
        "steep microstick line from −X to X_s, and the corner at V_s."
    ),
    "estimation_error": (
        "Error of F_k for every approach, pair of levels and frequency: direct integration is exact to rounding, the "
        "Fourier balance is off by less than a tenth of a per cent, and the harmonic approaches agree with each other, "
        "are good at resonance and off by ten per cent and more elsewhere, most with a common phase."
    ),
}
"""Alternative text of each figure in the paper's case, by the name of its file."""

__all__ = ["ALT", "estimation_error", "figure3", "friction_velocity_loop", "save", "schematic"]

# Loaded when they are asked for: the page takes looks and values from this room, and does without matplotlib.
_MODULES = {
    "estimation_error": "error_levels",
    "figure3": "cycle",
    "friction_velocity_loop": "cycle",
    "save": "style",
    "schematic": "schematic",
}


def __getattr__(name: str) -> object:
    if name not in _MODULES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = getattr(import_module(f".{_MODULES[name]}", __name__), name)
    globals()[name] = value  # in place of a module of that name, which its import leaves here
    return value
