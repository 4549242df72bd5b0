"""Cameras: lenses, projection, refraction at the wall, and what lies within the body."""
