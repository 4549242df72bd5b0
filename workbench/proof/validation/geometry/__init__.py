"""`workbench validate geometry`, `meshes`, `moulds`, `parts` and random sensors."""
