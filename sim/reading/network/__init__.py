"""The learned reader: a network from two photographs to touch, its file, its loss, its use."""
