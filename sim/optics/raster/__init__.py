"""Images: depth, visibility, shading, markers, and the image sensor."""
