"""A watertight triangle mesh (STL, OBJ or STEP); its -Z side meets the skin."""

from __future__ import annotations

from workbench.core.objects.kind import Group, Kind

KIND = Kind(place=17, group=Group.OTHER, edge_share=None, of_triangles=True)
