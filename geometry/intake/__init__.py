"""Bodies from files: read, mended or remeshed, and made a sensor's layers."""
