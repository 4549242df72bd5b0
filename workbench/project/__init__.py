"""Project folders: designs and their files, kept objects and photos, the last state."""
