"""Sensors as they might really have been built: hidden parameters, photographs, and the truth."""
