"""The Make tab."""
