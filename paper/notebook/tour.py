# ---
# jupyter:
#   jupytext:
#     text_representation:
#       extension: .py
#       format_name: percent
#   kernelspec:
#     display_name: Python 3
#     language: python
#     name: python3
# ---

# %% [markdown]
# # Damping from a balance of energy: a guided tour
#
# A mass on a spring is shaken. It loses energy in two ways: to a viscous damper $c$, and to a dry contact that slips
# with the force $F_k$. Liang and Feeny (2010) separate the two with one idea: *in a steady vibration, what goes in
# over a cycle comes out over that cycle.* This tour builds such a mass, looks at how it moves, finds $F_k$ and $c$
# from its motion, drives the method to where it fails, and mends it.
#
# You need to know what a damped oscillator is, and a little Python. Every number and picture of the notebook is
# computed when it is built. To try things yourself, open `paper/notebook/tour.py` in Jupyter (it is a notebook in
# plain text; *Open With → Notebook*), or turn it into one:
#
# ```
# jupytext --to notebook paper/notebook/tour.py
# ```
#
# We begin with what the cells need. All numbers are in SI units, whatever the plots show.

# %%
import math

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd

from dampbalance import BaseMotion, Oscillator, steady_orbit
from dampbalance.figures.looks import in_maths, label_of, look_of
from dampbalance.figures.style import FAINT, MM, SLIP, STICK, STYLE

plt.rcParams.update(STYLE)  # the look of this project's figures

# %% [markdown]
# ## An oscillator with a compliant contact
#
# The base moves by $y = Y \cos \omega t$ and pulls the mass through the spring $k$. The contact is itself a spring,
# $K_z$, in series with a slider: it sticks and deflects by $z$ until the force $K_z z$ reaches $F_k$, then slips. So
#
# $$ m \ddot x + c \dot x + k x + K_z z = k Y \cos \omega t, \qquad \left|z\right| \le Z_m = F_k / K_z, $$
#
# where $z$ follows $x$ in stick and stays at $\pm Z_m$ in slip: Eqs. (1)–(3) of the paper. These are the paper's
# values:

# %%
oscillator = Oscillator(m=2.42, c=90.0, k=2310.0, K_z=208_000.0, F_k=1.28)

print(f"natural frequency  {oscillator.omega_n / (2 * math.pi):.4f} Hz")
print(f"damping ratio ζ    {oscillator.zeta:.3f}")
print(f"deflection Z_m     {1e6 * oscillator.Z_m:.3f} µm, at which the contact lets go")

# %% [markdown]
# The contact is ninety times stiffer than the spring, and lets go after six thousandths of a millimetre. On most
# plots you would take it for rigid. We shall see that it is not.
#
# ## How it moves
#
# Shake the base by 4 mm at 4.92 Hz, close to resonance, and wait until the motion repeats itself. `steady_orbit` does
# not wait: between its events the motion is linear, so the steady orbit follows in closed form, exact to rounding.

# %%
RESONANCE, BELOW, ABOVE = 4.92, 3.5, 11.1  # Hz: the paper's three frequencies


def motion(Y, hertz):
    """Base motion of amplitude Y, m, at a frequency in Hz."""
    return BaseMotion(Y=Y, omega=2 * math.pi * hertz)


orbit = steady_orbit(oscillator, motion(0.004, RESONANCE))
print(orbit.regime)

# %% [markdown]
# *One slip onset per half cycle* is the pattern that the method is made for. Here is one period of it.

# %% alt="Base and mass over one period, a quarter of a period apart; contact force: a square wave, steep in stick."
t = np.linspace(0.0, orbit.motion.period, 8001)
x, v, acceleration, z = orbit.state(t)

figure, (above, below) = plt.subplots(2, 1, sharex=True, figsize=(150 * MM, 88 * MM))
above.plot(1e3 * t, 1e3 * orbit.motion.y(t), color=FAINT, label="base $y$")
above.plot(1e3 * t, 1e3 * x, color=SLIP, lw=1.4, label="mass $x$")
above.set_ylabel("displacement (mm)")
above.set_ylim(-5.0, 6.6)
above.legend(loc="upper center", ncols=2)
below.plot(1e3 * t, oscillator.K_z * z, color=SLIP, lw=1.4, label="contact force $K_z z$")
for reversal in (orbit.t_1 + orbit.motion.period, orbit.t_2):
    below.axvspan(
        1e3 * reversal, 1e3 * (reversal + orbit.t_s), color=STICK, alpha=0.35, lw=0, label="stick"
    )
below.set_xlabel("time (ms)")
below.set_ylabel("contact force (N)")
below.set_ylim(-1.6, 2.2)
handles, labels = below.get_legend_handles_labels()
below.legend(handles[:2], labels[:2], loc="upper center", ncols=2)
figure.tight_layout()

# %% [markdown]
# The mass lags the base by almost a quarter of a period, as it should at resonance. The contact slips nearly all the
# time. Only for some three milliseconds after each reversal of the velocity does it stick, while its spring swings
# from one end to the other.
#
# ## Two loops that show the contact
#
# Plotted against velocity, the friction force makes a loop: flat at $\pm F_k$ in slip, with a steep branch on either
# side of $\dot x = 0$ in stick. For a rigid contact both branches would be one vertical line.

# %% alt="Friction force against velocity: flat at plus and minus F_k, joined by two curved stick branches."
from dampbalance.figures.cycle import friction_velocity_loop

friction_velocity_loop(orbit)

# %% [markdown]
# In an experiment nobody sees the friction force. But an accelerometer sees its jump: in stick the mass hangs on a
# spring ninety times stiffer, so that the acceleration against displacement runs along a steep **microstick line**,
# from the reversal at $-X$ to the onset of slip at $X_s$. Its length is $X + X_s = 2 Z_m$, and its slope is about
# $-(k + K_z)/m$.

# %% alt="Acceleration against displacement: a narrow falling loop; enlarged, the microstick line from −X to X_s."
stick = np.linspace(orbit.t_1, orbit.t_1 + orbit.t_s, 50)
x_stick, _, acceleration_stick, _ = orbit.state(stick)

figure, (whole, left_end) = plt.subplots(1, 2, figsize=(180 * MM, 70 * MM))
for axes in (whole, left_end):
    axes.plot(1e3 * x, acceleration, color=SLIP)
    axes.plot(1e3 * x_stick, acceleration_stick, color=STICK, lw=1.8)
    axes.set_xlabel("displacement $x$ (mm)")
    axes.set_ylabel(r"acceleration $\ddot x$ (m/s²)")
near = 1e3 * (-orbit.X + 2 * oscillator.Z_m * np.array([-0.6, 2.6]))
left_end.set_xlim(near)
left_end.locator_params("x", nbins=4)
left_end.set_ylim(1.0, 3.4)
for place, name in ((-orbit.X, "$-X$"), (orbit.X_s, "$X_s$")):
    left_end.axvline(1e3 * place, color=FAINT, lw=0.5, zorder=0)
    left_end.annotate(
        name, (1e3 * place, 3.4), xytext=(0, 3), textcoords="offset points", ha="center"
    )
figure.tight_layout()

# %%
slope = (acceleration_stick[-1] - acceleration_stick[0]) / (orbit.X_s + orbit.X)
print(f"length of the line, X + X_s   {1e6 * (orbit.X + orbit.X_s):.3f} µm")
print(f"twice Z_m                     {2e6 * oscillator.Z_m:.3f} µm")
print(f"K_z from its slope            {-oscillator.m * slope - oscillator.k:.0f} N/m")
print(f"K_z from its length and F_k   {2 * oscillator.F_k / (orbit.X + orbit.X_s):.0f} N/m")

# %% [markdown]
# The slope misses $K_z$ by some six per cent, because damper and drive change their forces, too, while the contact
# sticks. The length does not miss: $K_z = 2F_k/(X + X_s)$ is exact once $F_k$ is known. (Eq. (10) of the paper prints
# the inverse, without the 2.)
#
# ## Reading features off
#
# The method needs no record of the friction force, only a few numbers per response. The paper takes five levels of
# excitation. `Features` holds what there is to read of each; of an exact orbit the features are exact.

# %%
from dampbalance.features import of_orbit, stack

LEVELS = (0.004, 0.006, 0.008, 0.010, 0.012)  # Y, m


def features_at(hertz, oscillator=oscillator, levels=LEVELS):
    """Exact features of the responses to all levels at one frequency, Hz."""
    return stack([of_orbit(steady_orbit(oscillator, motion(Y, hertz))) for Y in levels])


features = features_at(RESONANCE)
pd.DataFrame(
    {
        "Y (mm)": 1e3 * features.Y,
        "X (mm)": (1e3 * features.X).round(4),
        "X + X_s (µm)": (1e6 * (features.X + features.X_s)).round(3),
        "V_s (mm/s)": (1e3 * features.V_s).round(3),
        "t_s (ms)": (1e3 * features.t_s).round(3),
        "φ (rad)": features.phi.round(4),
    }
).set_index("Y (mm)")

# %% [markdown]
# $X$ is the peak, $X_s$ and $V_s$ are displacement and velocity at the onset of slip, $t_s$ is how long the contact
# has stuck by then, and $\varphi$ is the lag of the velocity reversal behind the peak of the base. The microstick
# line has the same length at every level: it belongs to the contact, not to the motion.
#
# ## One level, one equation
#
# Over a cycle the spring, the mass and the contact spring return all that they store. What the base puts in is lost
# to the slider and to the damper:
#
# $$ a F_k + b c = W, \qquad b = \oint \dot x^2\,\mathrm{d}t, \qquad W = \oint k y \dot x\,\mathrm{d}t, $$
#
# where $a$ is the distance slid.
#
# Two unknowns, and one such equation for each level. In the plane of $F_k$ and $c$ each level is a straight line;
# where the lines meet is the answer. Each *approach* of the paper is a way to get $a$, $b$ and $W$. **Direct
# integration** takes them from the recorded signals, and is exact.

# %%
from dampbalance.balance import APPROACHES, Rows
from dampbalance.solver import least_squares, pair

rows = APPROACHES["direct"](features, oscillator.k)
a, b, W = rows.terms["F_k"], rows.terms["c"], rows.W
pd.DataFrame(
    {
        "Y (mm)": 1e3 * features.Y,
        "a (mm)": (1e3 * a).round(4),
        "b (mm²/s)": (1e6 * b).round(2),
        "W (mJ)": (1e3 * W).round(4),
        "share lost to friction": [f"{s:.1%}" for s in a * oscillator.F_k / W],
    }
).set_index("Y (mm)")

# %% [markdown]
# Keep the last column in mind. At the highest level friction takes six per cent of the energy: an error of one per
# cent in $W$ is there an error of a sixth in the work of friction.
#
# The other approaches take the motion for harmonic, $x = X \cos(\omega t - \varphi)$. Then $b = \pi\omega X^2$, $W =
# \pi k Y X \sin\varphi$, and the distance slid follows from whichever mark of the slip onset was read: $a = 2(X -
# X_s)$ from its place, $2X(1 + \cos\omega t_s)$ from its time, $2X\bigl(1 + \sqrt{1 - (V_s/\omega X)^2}\bigr)$ from
# its velocity. An approach is a function from features to rows, and that is all it is:

# %%
{name: approach.rows.__name__ for name, approach in APPROACHES.items()}

# %% [markdown]
# ## Identify
#
# Five lines in a plane: solve them in the sense of least squares, once for each approach of the paper.

# %%
PAPER = ("direct", "X_s", "t_s", "V_s")


def identified(features, approaches=PAPER, oscillator=oscillator):
    """F_k and c by each approach, and how far they are from those of the oscillator."""
    fits = {name: least_squares(APPROACHES[name](features, oscillator.k)) for name in approaches}
    return pd.DataFrame(
        {
            "F_k (N)": [f"{fit['F_k']:.4f}" for fit in fits.values()],
            "error of F_k": [f"{fit['F_k'] / oscillator.F_k - 1:+z.2%}" for fit in fits.values()],
            "c (N s/m)": [f"{fit['c']:.4f}" for fit in fits.values()],
            "error of c": [f"{fit['c'] / oscillator.c - 1:+z.3%}" for fit in fits.values()],
        },
        index=pd.Index(fits, name="approach"),
    )


identified(features)

# %% [markdown]
# Close to resonance all is well: a few readings give $F_k$ within a hundredth, and $c$ within a thousandth. This is
# the paper's main result, and it holds.
#
# ## Break it
#
# Now take the same oscillator to 11.1 Hz, and do as the paper does: its formulas for two levels use *one* phase
# $\varphi$ and one $t_s$ for all, the means over the levels. Five pairs of levels give five estimates of $F_k$. Here
# are their errors, near resonance and away from it.

# %%
PAIRS = {"1-2": (0, 1), "2-3": (1, 2), "3-4": (2, 3), "4-5": (3, 4), "1-5": (0, 4)}


def errors_by_pair(features):
    """Errors of F_k pair by pair, with the phase and the slip time shared by all levels, as in the paper."""
    shared = features.with_common("phi", "t_s")
    rows = {name: APPROACHES[name](shared, oscillator.k) for name in PAPER}
    return pd.DataFrame(
        {
            f"pair {label}": [
                f"{pair(r, *two)['F_k'] / oscillator.F_k - 1:+z.1%}" for r in rows.values()
            ]
            for label, two in PAIRS.items()
        },
        index=pd.Index(rows, name="approach"),
    )


errors_by_pair(features)

# %%
features_above = features_at(ABOVE)
errors_by_pair(features_above)

# %% [markdown]
# Direct integration does not mind. The harmonic approaches, all three, lose two thirds of $F_k$. And they agree with
# one another: five pairs and three approaches tell the same wrong story. In the plane of $F_k$ and $c$ one sees how:
# the lines still meet nearly in a point, but far from the true one. Agreement, and a small residual, do not make an
# answer right.

# %% alt="A line per level in the plane of F_k and c. At 4.92 Hz all cross at the truth; at 11.1 Hz X_s does not."
F_k = np.array([0.2, 1.8])
looks = {"direct": (FAINT, "-"), "X_s": (look_of("X_s").colour, (0, (4, 2)))}

figure, panels = plt.subplots(1, 2, figsize=(180 * MM, 72 * MM), sharey=True)
for axes, hertz in zip(panels, (RESONANCE, ABOVE), strict=True):
    for name, (colour, dashes) in looks.items():
        shared = features_at(hertz).with_common("phi", "t_s")
        rows = APPROACHES[name](shared, oscillator.k)
        for i, (a, b, W) in enumerate(zip(*rows.terms.values(), rows.W, strict=True)):
            label = in_maths(label_of(name)) if i == 0 else None
            axes.plot(F_k, (W - a * F_k) / b, color=colour, ls=dashes, lw=0.9, label=label)
    axes.plot(oscillator.F_k, oscillator.c, "o", color=STICK, ms=5, label="true values", zorder=3)
    axes.set_title(f"{hertz} Hz")
    axes.set_xlabel("$F_k$ (N)")
    axes.set_xlim(F_k)
    axes.locator_params("x", nbins=4)
    axes.set_ylim(75.0, 125.0)
panels[0].set_ylabel("$c$ (N s/m)")
panels[1].legend(loc="upper right")
figure.tight_layout()

# %% [markdown]
# Which of $a$, $b$, $W$ is to blame? Compare each with the exact one, and ask what an error of that size does to
# $F_k$.


# %%
def blame(features):
    """Errors of the X_s rows, term by term; the last column is what that of W does to the share of friction."""
    exact = APPROACHES["direct"](features, oscillator.k)
    harmonic = APPROACHES["X_s"](features, oscillator.k)
    share = exact.terms["F_k"] * oscillator.F_k / exact.W
    error = {
        "a": harmonic.terms["F_k"] / exact.terms["F_k"] - 1,
        "b": harmonic.terms["c"] / exact.terms["c"] - 1,
        "W": harmonic.W / exact.W - 1,
    }
    return pd.DataFrame(
        {
            "Y (mm)": 1e3 * features.Y,
            **{f"error of {term}": [f"{e:+z.3%}" for e in error[term]] for term in error},
            "friction's share of W": [f"{s:.1%}" for s in share],
            "error of W ÷ share": [f"{e:+z.1%}" for e in error["W"] / share],
        }
    ).set_index("Y (mm)")


blame(features_above.with_common("phi", "t_s"))

# %% [markdown]
# The distance slid is right to the last digit: between two reversals the mass slides from $X_s$ to $X$, whatever the
# shape of its motion. The error is in $W = \pi k Y X \sin\varphi$: too small at the lowest level, too large at the
# highest. Friction takes a small share of $W$, so that an error of a few per cent in $W$ is a large one in the work
# of friction.
#
# ## Three causes
#
# The base moves harmonically. By orthogonality, only the *fundamental* of $x$ takes work from it, with its own lag
# $\varphi_1$: $W = \pi k Y X_1 \sin\varphi_1$, exactly. Against that, the paper's pairs are wrong in three ways.
#
# 1. **Which phase.** It is read where the velocity reverses. The contact adds higher harmonics, and they shift the
#    reversal away from that of the fundamental.
# 2. **One phase for all levels.** Friction weighs less at a higher level, so the lag changes from level to level, and
#    with it $\sin\varphi$. (The paper's least squares takes each level's own phase.)
# 3. **The peak for the amplitude.** The peak $X$ stands where the amplitude $X_1$ of the fundamental belongs, in $W$
#    and in $b$.
#
# How large are the first two? The table compares $\sin\varphi$ of the reversal with $\sin\varphi_1$, on average over
# the levels, and tells how far $\sin\varphi_1$ spreads from the lowest level to the highest.

# %%
FREQUENCIES = (BELOW, RESONANCE, ABOVE)


def causes(features):
    """How far sin φ of the reversal is off on average, and how far sin φ_1 spreads over the levels."""
    sine, sine_1 = np.sin(features.phi_reversal), np.sin(features.phi_fundamental)
    return float(np.mean(sine / sine_1 - 1)), float(sine_1.max() / sine_1.min() - 1)


found = [causes(features_at(f)) for f in FREQUENCIES]
pd.DataFrame(
    {
        "which phase: sin φ off by": [f"{off:+z.2%}" for off, _ in found],
        "one for all: sin φ_1 spreads by": [f"{spread:.2%}" for _, spread in found],
    },
    index=pd.Index([f"{f} Hz" for f in FREQUENCIES], name="frequency"),
)

# %% [markdown]
# Near resonance the sine is at its maximum, and forgives both. Below it the two are similar in size; above it the
# spread is by far the larger.
#
# ## Mend it, one thing at a time
#
# Take the recipe of the paper's pairs, $X_s$ and one phase for all levels, and change one thing: (a) give each level
# its own phase, still that of the reversal, as the paper does in its least squares; (b) or that of the upward zero
# crossing of $x$, which the paper's text names; (c) share one phase, but that of the fundamental; (d) give each level
# its own phase of the fundamental. All five levels enter, by least squares.
#
# Or (e), give up the harmonic shape. Write the motion as what it is, a Fourier series $x = \sum_n X_n \cos(n\omega t -
# \varphi_n)$, and integrate again:
#
# $$ W = \pi k Y X_1 \sin\varphi_1, \qquad b = \pi\omega \sum_n n^2 X_n^2, \qquad a = 2(X - X_s). $$
#
# The first formula is the one above; the last is exact, too. Only $b$ is cut off, after the fifth harmonic. This is a
# **Fourier balance**. $X_1$ and $\varphi_1$ are what a lock-in amplifier shows, averaged over as many cycles as you
# like; nothing needs to be integrated over a cycle.

# %%
MENDS = {
    "as in the paper's pairs: one phase of the reversal": lambda f: (
        "X_s",
        f.with_common("phi", "t_s"),
    ),
    "(a) each level's phase of the reversal": lambda f: ("X_s", f),
    "(b) each level's phase of the zero crossing": lambda f: ("X_s", f.with_phase("zero_crossing")),
    "(c) one phase of the fundamental": lambda f: (
        "X_s",
        f.with_phase("fundamental").with_common("phi"),
    ),
    "(d) each level's phase of the fundamental": lambda f: ("X_s", f.with_phase("fundamental")),
    "(e) Fourier balance": lambda f: ("fourier", f),
}


def error_of_F_k(approach, features):
    """Relative error of F_k by least squares over all levels."""
    return least_squares(APPROACHES[approach](features, oscillator.k))["F_k"] / oscillator.F_k - 1


mended = {
    f"{hertz} Hz": [error_of_F_k(*mend(features_at(hertz))) for mend in MENDS.values()]
    for hertz in FREQUENCIES
}
pd.DataFrame(
    {f"F_k, {at}": [f"{error:+.2%}" for error in errors] for at, errors in mended.items()},
    index=pd.Index(MENDS, name="error of"),
)

# %% [markdown]
# Read it by columns, beginning with (d), where only the third cause is left. At resonance it is all of the error, and
# at 3.5 Hz it is +4 %. From there the wrong phase alone, (a), and the common phase alone, (c), each shift $F_k$
# nearly as far as both together: the effects do not add. At 11.1 Hz the common phase costs most: (c) is no better for
# its correct phase, and (a), the paper's own least squares, does far better. Only (d), without both, is back within a
# few per cent. The zero crossing, (b), lies between, because it is shifted less. The Fourier balance, (e), corrects
# the third cause as well, with no more effort at the bench.
#
# It is not a matter of three lucky frequencies:

# %% alt="Error of F_k from 2 to 15 Hz: the paper's recipe holds only near resonance, the Fourier balance throughout."
from dampbalance.figures.grid import signed_axis
from dampbalance.figures.series import signed_scale

hertz = np.linspace(2.0, 15.0, 131)
by_frequency = [features_at(f) for f in hertz]

figure, axes = plt.subplots(figsize=(150 * MM, 78 * MM))
looks = {  # in the order of the recipes: colour, dashes
    "as in the paper's pairs": (STICK, "-"),
    "(a) each, reversal": (FAINT, "-"),
    "(b) each, zero crossing": (FAINT, (0, (4, 2))),
    "(c) one, fundamental": (STICK, (0, (4, 2))),
    "(d) each, fundamental": (look_of("X_s").colour, "-"),
    "(e) Fourier balance": (look_of("fourier").colour, "-"),
}
errors = [
    np.array([100 * error_of_F_k(*mend(each)) for each in by_frequency]) for mend in MENDS.values()
]
for (label, (colour, dashes)), error in zip(looks.items(), errors, strict=True):
    axes.plot(hertz, error, color=colour, ls=dashes, label=label)
signed_axis(axes, signed_scale(errors, 0.1, 1000.0))  # linear from -0.1 % to 0.1 %
axes.axvline(oscillator.omega_n / (2 * math.pi), color=FAINT, lw=0.4, zorder=0)
axes.set_xlabel("frequency (Hz)")
axes.set_ylabel("error of $F_k$ (%)")
axes.set_xlim(hertz[[0, -1]])
axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))
figure.tight_layout()

# %% [markdown]
# Where a curve crosses zero, two errors cancel; that is luck, not accuracy. What counts is how far from zero it lies
# elsewhere.

# %% [markdown]
# ## From records
#
# At a bench nobody hands you an orbit. You have sampled signals with noise, and want to know how sure the answer is.
# Record the same five levels at 3.5 Hz.

# %%
from dampbalance import identify, measured_orbit


def record(Y, seed):
    """Base and mass at 1 kHz for twenty cycles, with one per cent of noise."""
    orbit = steady_orbit(oscillator, motion(Y, BELOW))
    return measured_orbit(orbit, rate_hz=1000.0, cycles=20.0, noise=0.01, seed=seed)


measured = identify([record(Y, i) for i, Y in enumerate(LEVELS)], stiffness=oscillator.k)
measured

# %% [markdown]
# The answer is one oscillator fitted to all records. Direct integration, which needs no shape of motion, checks it.
#
# What you need to go on is in `measured`: `values`, `intervals`, `covariance`, the `rows` of the balance,
# `to_frame()` for all numbers. `identify` takes your files as well, in any format, or tables of pandas, or arrays:
# `identify(["level1.csv", "level2.csv"], stiffness=2310)`. Here are the rows and their residuals:

# %% alt="Rows of the balance on a straight line of slope F_k; the residual of each over its standard deviation."
axes = measured.plot("balance")

# %% [markdown]
# ## Exercises
#
# Guess first, then change a cell and look. The outcomes are computed below each question.
#
# **1. Overlook the compliance.** Suppose you never saw the microstick line and took the contact for rigid, $X_s =
# -X$. How much longer is the distance slid, and how much worse does the X_s approach become at resonance? (All levels
# have equal weights here, as in the paper.)

# %% tags=["outcome"]
rigid = features.replaced(X_s=-features.X)
a, a_rigid = (APPROACHES["X_s"](each, oscillator.k).terms["F_k"] for each in (features, rigid))
longer = a_rigid / a - 1
print(f"a grows by {longer.min():.2%} to {longer.max():.2%}")
identified(rigid, ("X_s",))

# %% [markdown] tags=["outcome"]
# It becomes *better*: a longer $a$ lowers $F_k$, and the harmonic $W$ had raised it. Two errors that cancel are no
# merit of the method. Try it at 3.5 Hz, where they add up.

# %% [markdown]
# **2. A softer contact.** Make $K_z$ ten times smaller. What becomes of the microstick line, and of the approaches?

# %% tags=["outcome"]
soft = Oscillator(m=2.42, c=90.0, k=2310.0, K_z=20_800.0, F_k=1.28)
soft_features = features_at(RESONANCE, soft)
print(f"X + X_s = {1e6 * (soft_features.X + soft_features.X_s)[0]:.1f} µm")
identified(soft_features, (*PAPER, "fourier"), soft)

# %% [markdown] tags=["outcome"]
# The line is ten times longer and easily read. Now the approaches by the time and the velocity of the slip onset
# suffer a little more than that by its displacement, because they need a harmonic motion to obtain $a$.

# %% [markdown]
# **3. Shake too gently.** What if the base moves by 0.7 mm only? And by 0.5 mm? Which features are left, and what
# does the balance make of them?

# %% tags=["outcome"]
for Y in (0.0007, 0.0005):
    gentle = steady_orbit(oscillator, motion(Y, RESONANCE))
    print(
        f"Y = {1e3 * Y} mm: {gentle.regime}; X = {1e6 * gentle.X:.2f} µm, X_s = {gentle.X_s:.3g} m"
    )
with_gentle = features_at(RESONANCE, levels=(0.0005, *LEVELS))
print("rows that enter:", APPROACHES["X_s"](with_gentle, oscillator.k).usable.tolist())
identified(with_gentle)

# %% [markdown] tags=["outcome"]
# At 0.5 mm the base pulls with $kY = 1.16$ N, less than $F_k$: the contact never lets go, there is no $X_s$ to read,
# and the harmonic approaches leave that level out. Direct integration keeps it: with $a = 0$ it still contributes to
# $c$.

# %% [markdown]
# **4. Two levels are enough?** Two equations give two unknowns. Are all pairs of levels equally good when every $W$
# is off by chance, with a standard deviation of one part in a thousand? Is it best to use all five levels? (Simulate
# 500 such experiments.)

# %% tags=["outcome"]
random = np.random.default_rng(seed=1)
exact = APPROACHES["direct"](features, oscillator.k)
noise = 1 + 1e-3 * random.standard_normal((500, len(exact.W)))
experiments = [Rows(exact.terms, exact.W * factor) for factor in noise]
choices = {"pair 1-2": (0, 1), "pair 4-5": (3, 4), "pair 1-5": (0, 4)}
scatter = {
    name: np.std([pair(rows, i, j)["F_k"] for rows in experiments])
    for name, (i, j) in choices.items()
}
scatter["all five"] = np.std([least_squares(rows)["F_k"] for rows in experiments])
for name, deviation in scatter.items():
    print(f"{name}: F_k scatters by {deviation / oscillator.F_k:.1%}")

# %% [markdown] tags=["outcome"]
# Levels far apart are best, and neighbours at the top are worst: there friction takes the least, and two lines that
# are almost parallel meet anywhere. The least squares over all five levels are *worse* than the pair 1-5. They weight
# each level by its $W$, and so mostly the highest ones, which contain the least information about friction. Divide
# each row by its $W$ first, and see.

# %% [markdown]
# **5. The amplitude.** In (d) the phase is right, and the peak $X$ still stands where the amplitude $X_1$ of the
# fundamental belongs. Put $X_1$ into $W$. Then put it into $b$, too. Does each step help?

# %% tags=["outcome"]
steps = {"(d) each level's phase of the fundamental": [], "X_1 in W": [], "X_1 in W and b": []}
for hertz in FREQUENCIES:
    each = features_at(hertz).with_phase("fundamental")
    rows, ratio = APPROACHES["X_s"](each, oscillator.k), each.X_1 / each.X
    with_b = {"F_k": rows.terms["F_k"], "c": rows.terms["c"] * ratio**2}
    stages = (rows, Rows(rows.terms, rows.W * ratio), Rows(with_b, rows.W * ratio))
    for errors, stage in zip(steps.values(), stages, strict=True):
        errors.append(least_squares(stage)["F_k"] / oscillator.F_k - 1)
pd.DataFrame(
    [[f"{error:+.2%}" for error in errors] for errors in steps.values()],
    columns=[f"F_k, {f} Hz" for f in FREQUENCIES],
    index=pd.Index(steps, name="error of"),
)

# %% [markdown] tags=["outcome"]
# The first step makes things worse: $X$ was wrong in $W$ and in $b$, and the two errors cancelled. Both steps
# together leave about one per cent at most. The rest is in $b$, which needs the third harmonic and the fifth.

# %% [markdown]
# ## Where to go from here
#
# - `README.md` says how to rebuild the paper's tables and figures, with a verdict on every printed number.
# - `paper/equations.md` leads from each equation to its function and to its test.
# - An approach of your own is one function from features to rows: pass it as an `Approach` to
#   `study`, which compares it with the others over any parameters; a damping term of your own is a `Term`.
