"""The Optics tab."""
