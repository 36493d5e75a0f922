"""Records of measurements: channels, units, mapping; read from the files of laboratories and written to them."""
