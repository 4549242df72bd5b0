"""The part of the membrane that takes part: cells, nodes, surface points, springs."""
