"""Benchmarks that a reader can rerun: `make bench`."""
