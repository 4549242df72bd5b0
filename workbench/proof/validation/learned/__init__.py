"""`workbench validate learned` and `forces`: the networks."""
