"""What stages return: bodies, meshes, light, contact, forces, images, maps, parts."""
