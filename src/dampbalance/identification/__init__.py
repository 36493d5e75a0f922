"""Measured records to F_k, c and K_z, each with an interval: what the command and the workflow run."""
