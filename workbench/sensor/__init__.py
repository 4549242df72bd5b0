"""A design as one call: poses of an object in, images and forces out; packs that carry it."""
