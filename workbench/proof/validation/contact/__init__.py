"""`workbench validate contact`: the contact solver beside closed forms and itself."""
