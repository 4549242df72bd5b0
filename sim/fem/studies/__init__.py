"""Specimens with known answers, for the finite-element solver."""
