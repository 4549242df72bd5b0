"""Presses relaxed to equilibrium, frame by frame, one or many at once."""
