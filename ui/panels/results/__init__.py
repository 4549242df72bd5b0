"""The right dock: image, forces, maps, log and timeline."""
