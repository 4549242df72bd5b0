"""The Shape tab."""
