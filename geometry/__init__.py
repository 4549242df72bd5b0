"""Bodies, meshes, moulds and files."""
