"""From records to harmonics, turning points, decays, loops and features."""
