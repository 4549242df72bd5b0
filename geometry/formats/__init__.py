"""Mesh files as bytes: OBJ, STL and 3MF."""
