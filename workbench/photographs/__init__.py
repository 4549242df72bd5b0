"""The photographs of a calibration in a project, and what the browser asks about them."""
