"""`workbench validate fem`: finite elements beside exact answers and other programs."""
