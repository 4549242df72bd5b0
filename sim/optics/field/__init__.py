"""The light field: baked at rest, and tabulated by the tilt of the skin."""
