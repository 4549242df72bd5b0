"""Surfaces of triangles: nearest places, rays, sections, holes, regions, offsets and remeshing."""
