"""Where the object goes: path, first touch, and what of the skin it covers."""
