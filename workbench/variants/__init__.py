"""Variants, score cards, sweeps, and how two sensors differ."""
