"""Studies that validation and tests run; the product does not."""
