"""Types, errors, units and hashing that every layer shares; imports the standard library and numpy only."""
