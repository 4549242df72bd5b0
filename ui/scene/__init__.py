"""The 3D view: body, lights, cameras, parts, maps, pressed frames."""
