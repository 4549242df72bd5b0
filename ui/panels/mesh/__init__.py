"""The tab Mesh: how finely the body is divided, and how good the cells are."""
