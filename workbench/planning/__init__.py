"""From a design and a press to the calls of all stages, and running those that are asked for."""
