"""Families of membranes: one file each, whose header is its manual page."""
