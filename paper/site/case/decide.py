"""Does the clamp of the mount keep its friction? The interval decides, not the value alone."""

import json
from pathlib import Path

LEAST = 2.0  # N, below which the clamp is to be tightened

found = json.loads(Path("found/identification.json").read_text())
low, high = found["maximum_likelihood"]["F_k_interval_N"]
verdict = found["maximum_likelihood"]["verdicts"]["F_k"]["verdict"]
if verdict != "usable":
    decision = "measure again: the friction force is not usable"
elif low >= LEAST:
    decision = "leave the clamp as it is"
elif high < LEAST:
    decision = "tighten the clamp"
else:
    decision = "measure more levels: the interval includes the limit"
print(f"F_k is between {low:.3f} and {high:.3f} N, and the limit is {LEAST} N: {decision}.")
