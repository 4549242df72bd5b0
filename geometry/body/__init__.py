"""Solid bodies: constructive geometry, signed distance, the layers of a sensor."""
