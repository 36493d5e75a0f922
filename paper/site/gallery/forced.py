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
# # Forced records in a notebook
#
# A mass on a spring was shaken at five levels. How much of its damping is friction? The records here are
# simulated, with 1 % of noise, so that the right answer is known; put your own files in their place by
# `records = read_records(["level1.csv", …])`.

# %%
import math

import matplotlib.pyplot as plt
import pandas as pd

from dampbalance import BaseMotion, Oscillator, identify, measured_orbit, steady_orbit

truth = Oscillator(m=2.42, c=9.0, k=2310.0, K_z=100_000.0, F_k=1.28)
records = [
    measured_orbit(
        steady_orbit(truth, BaseMotion(Y=level / 1000, omega=2 * math.pi * 4.5)),
        rate_hz=1000.0,
        cycles=20.0,
        noise=0.01,
        seed=level,
        channels=("base_displacement", "acceleration"),
    )
    for level in (1, 2, 3, 4, 5)
]

# %% [markdown]
# ## Look at them first
#
# Three cycles of each level: is the motion steady, does a channel end in a plateau, does anything jump?

# %% alt="Acceleration over time at five levels: steady, with a jump at each reversal."
figure, axes = plt.subplots(figsize=(7, 2.6), layout="constrained")
for record in records:
    response = record["acceleration"]
    shown = response.t < 3 / 4.5
    axes.plot(response.t[shown], response.values[shown], linewidth=0.7)
axes.set(xlabel="t (s)", ylabel="acceleration (m/s²)")
plt.show()

# %% [markdown]
# ## Identify
#
# The stiffness of the spring is needed, measured statically. The mass is optional and tests it.

# %%
found = identify(records, stiffness=2310.0, mass=2.42)
print(found)

# %% [markdown]
# ## Does the model explain the motion?
#
# Each record folded onto one cycle of the drive, with the fitted oscillator. A pattern in the residual below would be a
# motion that the model does not explain.

# %% alt="The acceleration over one cycle, a panel for each level, with a step where the mass turns; residuals below."
found.plot("cycles")
plt.show()

# %% [markdown]
# ## Do all levels lie on one line?
#
# Each level is a point. The slope of the line is F_k, its intercept is c; on the right are the residuals.

# %% alt="Left, points of five levels on a straight line; right, residuals about zero."
found.plot("balance")
plt.show()

# %% [markdown]
# ## Damping at each amplitude
#
# With friction, damping depends on the amplitude: small motions are damped most. This is what a linear model at that
# amplitude needs.

# %%
levels = pd.DataFrame(found.document()["damping"]["levels"])
levels[["X_m", "friction_share", "equivalent_damping_ratio", "loss_factor", "Q"]].round(4)

# %% [markdown]
# Check the answer against the truth, which simulated records have: every interval should hold it in 95 of 100 cases.

# %%
pd.DataFrame(
    {
        symbol: (getattr(truth, symbol), found.values[symbol], *found.intervals[symbol])
        for symbol in ("F_k", "c", "K_z")
    },
    index=["truth", "identified", "low", "high"],
).T.round(3)

# %% [markdown]
# **To try:** state the stiffness 3 % too large, `identify(records, stiffness=1.03 * 2310.0, mass=2.42)`. What does the
# verdict say, and why could it not say so without the mass?
