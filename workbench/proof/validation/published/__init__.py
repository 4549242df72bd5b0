"""Our bodies beside those that were released with the paper."""
