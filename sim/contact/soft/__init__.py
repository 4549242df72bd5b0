"""Objects that deform themselves."""
