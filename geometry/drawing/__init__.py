"""Bodies and parts, drawn off screen."""
