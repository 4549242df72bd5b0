"""The page of searches by goals."""
