"""Results as they are shown: colours, figures, words, meshes of the 3D view."""
