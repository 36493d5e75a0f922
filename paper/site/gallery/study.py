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
# # A study in a notebook
#
# Before a rig is built: how well will the method work on it? A study simulates the records of many oscillators,
# identifies each by several approaches and compares the result with the truth.

# %%
import matplotlib.pyplot as plt

from dampbalance import study

# %% [markdown]
# ## At which frequency to shake
#
# The frequency of the drive over the natural one, for two of the paper's approaches and for the Fourier balance, from
# records with 1 % of noise. The paper's fail off resonance, because they take the phase of the velocity reversal for
# that of the work; the noise decides how far the Fourier balance errs.

# %% alt="Errors over the frequency of the drive: the paper's grow off resonance, the Fourier balance's do not."
frequency = study(
    {"omega_over_omega_n": {"from": 0.5, "to": 2.4, "count": 48}},
    estimation={"approaches": "X_s,t_s,fourier"},
    route={"kind": "measured", "sampling_hz": 1000, "noise": 0.01, "seed": 1},
)
frequency.plot()
plt.show()

# %%
frequency

# %% [markdown]
# ## How stiff the contact may be
#
# Errors over the stiffness of the contact and the damping ratio, as a map. Without a `route` the responses are exact:
# the errors are those of the approach itself, and thousands of cases take a second. `to_frame()` has all numbers of
# each case.

# %% alt="A map of the largest error over contact stiffness and damping ratio."
both = study(
    {
        "K_z_over_k": {"from": 3.0, "to": 300.0, "count": 24, "spacing": "log"},
        "zeta": {"from": 0.02, "to": 0.5, "count": 24, "spacing": "log"},
    },
    estimation={"approaches": "fourier"},
)
both.plot("map")
plt.show()

# %%
both.to_frame().iloc[:3, :6]

# %% [markdown]
# **To try:** add `levels_m=[0.002, 0.004]` to a study. What do fewer and smaller levels cost? A study with a figure
# and a text, or one that is larger than memory, is a file of a few lines: see *Studies*.
