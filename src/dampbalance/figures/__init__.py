"""The figures of the paper, and one it lacks: from orbits and tables of estimates to pictures.

`looks.py` says how each approach looks, `style.py` how everything does. Each function is pure and returns a matplotlib
`Figure`; `save` writes it as SVG and PNG. `ALT` says in a sentence what each shows in the paper's case, for readers
who cannot see it.
"""

from __future__ import annotations

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
