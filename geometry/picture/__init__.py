"""Pictures of bodies and parts, drawn off screen."""
