"""Photographs of a built sensor read as touch: depth, contact and force."""
