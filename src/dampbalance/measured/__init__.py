"""From measured signals to features: channels and units, conditioning, cycles, slip onset, uncertainty."""
