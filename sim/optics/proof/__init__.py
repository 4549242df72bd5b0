"""Checks of the optics against closed forms and other programs."""
