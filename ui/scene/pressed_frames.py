"""What is drawn of a press, worked out without the page: so it can be done in any thread.

Colours come from the scale of all frames together; triangles, normals' sums and the scale of the
arrows are worked out once for all quantities of a press.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from ui.page.imaging import coloured_glb, heat_colours
from ui.scene.sensor import SKIN_COLOUR
from workbench.core.result.results import Skin
from workbench.view.force_sources import Forces
from workbench.view.glb import Topology
from workbench.view.quantities import Quantity, Shown, force_arrows, largest_arrow_N, shown
from workbench.view.section_cut import Plane


@dataclass(frozen=True, kw_only=True, slots=True)
class PressedFrames:
    """A press in the colours of one quantity."""

    skin: Skin
    contact: Forces
    against: Forces | None
    """Another source, where the difference from it is on show."""
    shown: Shown
    topology: Topology
    arrow_top_N: float
    """Force of the longest arrow of all frames."""

    def glb(self, number: int, plane: Plane | None) -> bytes:
        """The skin of frame `number`, counted from 1, as a GLB file, cut or whole."""
        moved = np.asarray(self.contact.displacement_mm[number - 1])
        points = (np.asarray(self.skin.points_mm) + moved).astype(np.float32)
        colours = heat_colours(self.shown.values[number - 1] / self.shown.top, SKIN_COLOUR)
        return coloured_glb(points, np.asarray(self.skin.faces), colours, plane, self.topology)

    def arrows_mm(self, number: int) -> np.ndarray:
        """Contact forces of frame `number` as arrows [mm], shape (N, 2, 3)."""
        return force_arrows(self.skin, self.contact, number - 1, top_N=self.arrow_top_N)

    def files(self, numbers: Sequence[int], plane: Plane | None) -> Iterator[tuple[int, bytes]]:
        """Frames and their GLB files, one after the other."""
        for number in numbers:
            yield number, self.glb(number, plane)


def pressed_frames(
    skin: Skin,
    contact: Forces,
    quantity: Quantity,
    before: PressedFrames | None = None,
    against: Forces | None = None,
) -> PressedFrames:
    """Measure a press in a quantity; `before` may be the same press in another one.

    With `against` the colours are those of the difference from that source.
    """
    same = before is not None and before.contact is contact and before.skin is skin
    known = before if same else None
    faces = np.asarray(skin.faces)
    return PressedFrames(
        skin=skin,
        contact=contact,
        against=against,
        shown=shown(skin, contact, quantity, against),
        topology=known.topology if known else Topology.of(faces, len(skin.points_mm)),
        arrow_top_N=known.arrow_top_N if known else largest_arrow_N(skin, contact),
    )
