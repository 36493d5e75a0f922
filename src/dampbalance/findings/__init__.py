"""Findings: what is odd about records or answers, as data, and the one table of their sentences."""
