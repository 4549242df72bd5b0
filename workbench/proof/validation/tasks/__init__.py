"""What shipped designs tell apart by touch, as recorded."""
