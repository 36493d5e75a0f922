"""The paper's numbers: how the authors obtained them, the tables side by side, and a verdict on each."""
