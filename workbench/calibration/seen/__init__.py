"""What the photographs of a calibration show: the set, contacts, drift, and places on the skin."""
