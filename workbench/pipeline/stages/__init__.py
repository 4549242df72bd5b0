"""The stages, one file each: named inputs, a pure function of them, what people read."""
