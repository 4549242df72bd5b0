"""Kinds of objects, one file each: its name stands in files, `KIND` says what the shape is."""
