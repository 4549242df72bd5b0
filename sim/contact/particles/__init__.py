"""The published particle method, for comparison."""
