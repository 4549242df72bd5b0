"""The View tab."""
