"""An indenter by name or by file, as the command line and the browser choose it."""

from __future__ import annotations

import contextlib
import math
from pathlib import Path

import numpy as np

from workbench.core.base.check import within
from workbench.core.base.errors import DesignError, shown
from workbench.core.base.mapping import suggest
from workbench.core.objects.kind import kind_of, kinds
from workbench.core.press.indenter import (
    DEFAULT_EDGE_RADIUS_MM,
    DEFAULT_SIZE_MM,
    LARGEST_MESH_MM,
    OF_TRIANGLES,
    Indenter,
    IndenterKind,
    IndenterMesh,
    widest_edge_mm,
)
from workbench.core.press.texture import SMOOTH, HeightImage, Pattern, Texture
from workbench.system.picture_size import picture_size

ALIASES = {alias: name for name, kind in kinds().items() for alias in kind.aliases} | {
    name.replace("_", "-"): name for name in kinds()
}
"""Other words for a kind."""
PRIMITIVES = tuple(k.value for k in IndenterKind if k is not OF_TRIANGLES)
PICTURES = (".png", ".jpg", ".jpeg", ".bmp", ".tif", ".tiff")
LETTER_MM, PICTURE_MM = 3.0, 6.0
"""Height of a capital and width of a picture where none is given."""
MOST_PIXELS = 4_000_000
MOST_PICTURE_BYTES = 40_000_000
"""As many as pixels of two bytes in four channels, with room for a header."""
SMALLER_PICTURE = "reduce the picture; contact resolves a few pixels per mm"


def choose_indenter(
    name: str,
    *,
    size_mm: float | None = None,
    edge_radius_mm: float | None = None,
    texture: Texture | str | None = None,
) -> Indenter:
    """A primitive or an everyday object by name, or the closed mesh of an STL, OBJ or STEP file.

    Without a size a primitive has 6 mm; a released head and all others have their own size in mm.
    The edge radius shrinks with small primitives so that the default always fits; a mesh keeps its
    edges unless one is stated.

    Args:
        name: "sphere", "cross", "key" ..., or the path of a file.
        size_mm: Diameter, else the largest width.
        edge_radius_mm: Rounding of edges and tips.
        texture: Pattern on the side that meets the skin; as text as `choose_texture` reads it.

    Raises:
        DesignError: If the name is unknown or the file is not a usable closed mesh.
    """
    from geometry.objects.everyday import EVERYDAY, everyday
    from geometry.objects.indenters import ENDINGS, load_mesh

    kind = ALIASES.get(name.lower(), name)
    if isinstance(texture, str):
        texture = choose_texture(texture)
    texture = texture or SMOOTH
    if kind in PRIMITIVES:
        return _primitive(IndenterKind(kind), size_mm, edge_radius_mm, texture)
    if name in EVERYDAY:
        return of_mesh(everyday(name), size_mm, edge_radius_mm, texture)
    if name.lower().endswith(ENDINGS) or Path(name).exists():
        return of_mesh(load_mesh(Path(name)), size_mm, edge_radius_mm, texture)
    raise DesignError(
        f"there is no indenter {shown(name)}",
        hint=f"{suggest(kind, [*PRIMITIVES, *EVERYDAY])}; or give the path of an STL, OBJ or "
        "STEP file",
        at="indenter",
    )


def choose_texture(words: str) -> Texture:
    """A texture as typed: PATTERN[:HEIGHT[:PITCH]], a picture's path, or letters=TEXT.

    Raises:
        DesignError: If it names no pattern, a number is none, or the picture cannot be read.
    """
    name, *numbers = words.split(":")
    at = "--texture"
    try:
        values = [float(number) for number in numbers]
    except ValueError:
        values = [math.nan]
    if len(values) > 2 or not all(math.isfinite(value) for value in values):
        raise DesignError(
            f"--texture is {shown(words)}, expected PATTERN or PATTERN:HEIGHT:PITCH in mm",
            hint="for example --texture waves:0.2:2",
            at=at,
        )
    height_mm = values[0] if values else SMOOTH.height_mm

    def pitch_mm(usual: float) -> float:
        return values[1] if len(values) == 2 else usual

    head, _, text = name.partition("=")
    if head == Pattern.LETTERS and text:
        return Texture(
            pattern=Pattern.LETTERS, text=text, height_mm=height_mm, pitch_mm=pitch_mm(LETTER_MM)
        )
    if name.lower().endswith(PICTURES):
        picture = load_heights(Path(name))
        return Texture(
            pattern=Pattern.IMAGE, image=picture, height_mm=height_mm, pitch_mm=pitch_mm(PICTURE_MM)
        )
    plain = [Pattern.NONE.value, Pattern.GRID.value, Pattern.DOTS.value, Pattern.WAVES.value]
    if name not in plain:
        raise DesignError(
            f"there is no texture {shown(name)}",
            hint=f"{suggest(name, plain)}; or letters=TEXT, or the path of a greyscale picture",
            at=at,
        )
    pitch = pitch_mm(SMOOTH.pitch_mm)
    return Texture(pattern=Pattern(name), height_mm=height_mm, pitch_mm=pitch)


def load_heights(path: Path) -> HeightImage:
    """A picture as heights, white high.

    Raises:
        DesignError: If it cannot be read or is too large.
    """
    import cv2

    at = "indenter.texture.image"
    size = path.stat().st_size if path.is_file() else 0
    if size > MOST_PICTURE_BYTES:
        raise DesignError(
            f"{path.name} has {size / 1e6:.0f} MB, more than {MOST_PICTURE_BYTES / 1e6:.0f} MB",
            hint=SMALLER_PICTURE,
            at=at,
        )
    data = b""
    with contextlib.suppress(OSError):
        data = path.read_bytes()
    width_px, height_px = picture_size(data) or (0, 0)
    if width_px * height_px > MOST_PIXELS:
        raise DesignError(
            f"{path.name} has {width_px} x {height_px} pixels, {width_px * height_px:,} in all; "
            f"the limit is {MOST_PIXELS:,}",
            hint=SMALLER_PICTURE,
            at=at,
        )
    try:
        raw = np.frombuffer(data, dtype=np.uint8)
        picture = cv2.imdecode(raw, cv2.IMREAD_GRAYSCALE) if width_px else None
    except cv2.error:
        picture = None
    if picture is None:
        raise DesignError(
            f"{path.name} is not a picture that can be read",
            hint="give the path of a greyscale PNG, JPEG, BMP or TIFF",
            at=at,
        )
    return HeightImage(heights=np.asarray(picture, dtype=np.float64) / 255.0)


def _primitive(
    kind: IndenterKind, size_mm: float | None, edge_radius_mm: float | None, texture: Texture
) -> Indenter:
    size = (kind_of(kind).own_mm or DEFAULT_SIZE_MM) if size_mm is None else size_mm
    widest = widest_edge_mm(kind, size)
    if widest is None:
        # It has no edge; a value here would only split one press into two keys.
        return Indenter(kind=kind, size_mm=size, texture=texture)
    edge = min(DEFAULT_EDGE_RADIUS_MM, widest) if edge_radius_mm is None else edge_radius_mm
    if edge_radius_mm is None:
        edge = max(edge, 0.0)
    return Indenter(kind=kind, size_mm=size, edge_radius_mm=edge, texture=texture)


def of_mesh(
    mesh: IndenterMesh,
    size_mm: float | None = None,
    rounding_mm: float | None = None,
    texture: Texture = SMOOTH,
) -> Indenter:
    """An object of triangles, in its own size unless one is given.

    Raises:
        DesignError: If the size is refused, or the texture does not fit it.
    """
    from geometry.objects.indenters import largest_width, scaled

    size = largest_width(mesh) if size_mm is None else size_mm
    # Checked before scaling, so that a size of zero is refused by name.
    hint = "" if size_mm is not None else "is the file in mm? give its size in mm"
    at = "indenter.size_mm"
    within(size, 0.5, LARGEST_MESH_MM, what="indenter size", unit="mm", at=at, hint=hint)
    return Indenter(
        kind=OF_TRIANGLES,
        size_mm=size,
        mesh=scaled(mesh, size),
        mesh_rounding_mm=rounding_mm or 0.0,
        texture=texture,
    )
