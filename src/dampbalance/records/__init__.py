"""Measured records: channels, units and mappings, read from files of laboratories and written to them."""
