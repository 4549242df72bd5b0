"""A design's light as the table that Taxim and its heirs read: for flat sensors."""
