"""What `run` and `export` leave in a folder: images, tables, meshes, summary, report."""
