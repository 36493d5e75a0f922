"""From samples to the oscillator of largest likelihood, and how much information records hold: the Cramér–Rao bound."""
