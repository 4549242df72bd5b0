"""Training of force networks on data sets: what is read, kept, measured and written."""
