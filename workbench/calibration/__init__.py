"""A design's light fitted to photographs of the sensor that was built from it."""
