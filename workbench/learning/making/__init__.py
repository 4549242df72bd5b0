"""How a data set is made: workers, presses side by side, progress."""
