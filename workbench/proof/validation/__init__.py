"""One module per room; each returns the rows of `workbench validate ROOM`."""
