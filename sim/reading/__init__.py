"""Reading touch from a photograph: the inverse of the light, on the skin of one design."""
