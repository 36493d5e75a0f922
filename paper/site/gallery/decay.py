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
# # A free decay in a notebook
#
# No shaker is at hand: pull the mass aside, let go, and record how the motion dies away. One such record gives both
# friction and viscous damping, and the logarithmic decrement, which laboratories use, gives neither.

# %%
import math

import matplotlib.pyplot as plt
import numpy as np

from dampbalance import Oscillator, identify, measured_ring_down

truth = Oscillator(m=2.42, c=1.0, k=2310.0, K_z=208_000.0, F_k=0.5)
decay = measured_ring_down(truth, x=0.01, rate_hz=1000.0, duration=6.0, noise=0.003, seed=1)

# %% [markdown]
# ## The decrement depends on the amplitude
#
# ln(x₁/x₂)/2π of successive peaks would be the damping ratio if there were no friction. Here it grows as the motion
# becomes small: friction takes the same from each peak, whatever is left of it.

# %% alt="Left, the decaying displacement; right, the decrement of each cycle, which rises at small peaks."
response = decay["displacement"]
smooth = np.convolve(response.values, np.ones(15) / 15, mode="same")
period = round(2 * math.pi / truth.omega_n / 1e-3)
peaks = np.array([smooth[i : i + period].max() for i in range(period // 2, 10 * period, period)])
ratios = np.log(peaks[:-1] / peaks[1:]) / (2 * math.pi)

figure, (left, right) = plt.subplots(1, 2, figsize=(7.5, 2.7), layout="constrained")
left.plot(response.t, 1000 * response.values, linewidth=0.6)
left.set(xlabel="t (s)", ylabel="x (mm)")
right.plot(1000 * peaks[:-1], 100 * ratios, "o", label="decrement of each cycle")
right.axhline(100 * truth.zeta, linestyle="--", label="c alone")
right.set(xlabel="peak (mm)", ylabel="damping ratio (%)")
right.legend(frameon=False)
plt.show()

# %% [markdown]
# ## Identify both
#
# The stiffness is that of a static test. If the mass is known instead, k = (2πf)² m with the frequency of the
# free swing.

# %%
found = identify(decay, stiffness=2310.0)
print(found)

# %% alt="The decay with the fitted motion on its samples, and below residuals without a pattern."
found.plot("decays")
plt.show()

# %% [markdown]
# The straight end of the envelope is friction, its curved beginning is c. Where the mass sticks, the fit ends.
#
# **To try:** set `F_k=0.05` above. Below which friction force does it become invisible?
