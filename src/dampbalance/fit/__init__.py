"""Data in, the oscillator of largest likelihood out; and the bound of what records can tell."""
