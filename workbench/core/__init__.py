"""Types, errors, units and hashing that every layer shares; imports only numpy."""
