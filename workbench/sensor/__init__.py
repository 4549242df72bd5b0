"""A design as one call: poses of an object in, images and forces out; packs that carry it."""

import os

# As on the command line: the program that imports this has an output of its own.
os.environ.setdefault("ENABLE_TAICHI_HEADER_PRINT", "0")
