"""Objects to press with, as meshes: everyday ones, files, and which side of them touches."""
