"""Cameras and LEDs that can be bought: what their makers say of them, and where."""
