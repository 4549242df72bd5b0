"""Moulds: parting, parts, channels, how they open, and what a printer cannot make of them."""
