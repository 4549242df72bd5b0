"""Data sets of presses: planned, computed by many processes, and read again for learning."""
