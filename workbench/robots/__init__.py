"""A sensor as robots' programs read it: masses, meshes, MJCF and URDF, in SI units."""
