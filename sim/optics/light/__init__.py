"""Lights and what reflects them: LEDs, spectra, the coating, bins by direction, ways along skin."""
