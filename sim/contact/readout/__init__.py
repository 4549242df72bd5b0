"""From a settled state to numbers, and what is refused."""
