"""Readings of touch beside what is known: renders of the same light, photons, and twins."""
