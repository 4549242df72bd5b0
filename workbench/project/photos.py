"""Picture files of a design: read from disk, kept in the project, named in design files.

A design file names a picture in `optics.background` or `optics.markers.picture`, and what one built
sensor shows in `optics.unit`: a file beside it or in the project folder or its `pictures`, or
`builtin:NAME` for one that is shipped. A project keeps each once, as its hash and the designer's
name.
"""

from __future__ import annotations

import functools
import re
from collections.abc import Mapping, Sequence
from importlib import resources
from pathlib import Path
from typing import Any

from workbench.core.base.errors import DesignError, shown
from workbench.core.base.mapping import suggest
from workbench.core.design.camera import Camera
from workbench.core.design.design import SensorDesign
from workbench.core.design.photo import MOST_BYTES, Photo, photo
from workbench.core.design.unit import Unit, unit
from workbench.system.named_files import BRING_IT, find_file
from workbench.system.uploads import own_name

FOLDER = "pictures"
BUILTIN = "builtin:"
FIELDS = ("optics.background", "optics.markers.picture", "optics.unit")
"""Where a design holds pictures."""
KEPT = re.compile(r"[0-9a-f]{32}-(.+)")
"""Name that a project gives a picture."""


@functools.cache
def shipped_photos() -> Mapping[str, Photo]:
    """The photographs that come with the workbench, by name."""
    folder = resources.files("designs") / "backgrounds"
    files = sorted(folder.iterdir(), key=lambda file: file.name)
    return {
        file.name: photo(file.name, file.read_bytes(), at="optics.background")
        for file in files
        if file.name.endswith(".png")
    }


def read_photo(
    name: Any, *, roots: Sequence[Path] = (Path(),), enclosed: bool = False, at: str
) -> Photo | Unit:
    """The picture, or the unit, that a design file names.

    Args:
        name: Path, or `builtin:` and the name of a shipped one.
        roots: Folders in which the file is looked for, in order, and in their `pictures`.
        enclosed: Whether the file must lie inside one of these.
        at: Field of the design, for messages.

    Raises:
        DesignError: If there is no such file, it cannot be read, is too large, or its name ends
            in no picture format.
    """
    if not isinstance(name, str) or not name:
        raise DesignError(
            f"{at} is {shown(name)}, expected the path of a picture", hint="write 'idle.png'", at=at
        )
    if name.startswith(BUILTIN):
        known = shipped_photos()
        short = name.removeprefix(BUILTIN)
        if short not in known:
            raise DesignError(
                f"there is no shipped picture {shown(short)}", hint=suggest(short, known), at=at
            )
        return known[short]
    folders = [folder for root in roots for folder in (root, root / FOLDER)]
    try:
        path = find_file([(folder, name) for folder in folders], enclosed=enclosed)
        if path is None:
            places = " and ".join(str(f / name) for f in folders) or "shipped pictures only"
            looked = f"looked for {places}; put it there, or write builtin:NAME"
            raise DesignError(
                f"there is no picture file {shown(name)}",
                hint=BRING_IT if enclosed else looked,
                at=at,
            )
        size = path.stat().st_size
        if size > MOST_BYTES:
            raise DesignError(
                f"{path.name} has {size} bytes, a picture has at most {MOST_BYTES}",
                hint="save it with fewer pixels",
                at=at,
            )
        kept = KEPT.fullmatch(path.name)
        make = unit if at == "optics.unit" else photo
        return make(kept[1] if kept else path.name, path.read_bytes(), at=at)
    except (OSError, ValueError) as error:
        # A path that is too long, or holds a zero, is refused by the system itself.
        raise DesignError(
            f"cannot read {name[:80]}: {getattr(error, 'strerror', None) or error}",
            hint="check the file",
            at=at,
        ) from error


def check_photos(design: SensorDesign) -> None:
    """Refuse pictures that cannot be used, before anything is computed.

    Raises:
        DesignError: If one cannot be read, or the background has another size than the camera.
    """
    camera = design.optics.camera
    for field, picture in design_photos(design).items():
        if isinstance(picture, Unit):
            _check_background(_idle(picture), camera.width_px, camera.height_px)
        elif field == "optics.background":
            _check_background(picture, camera.width_px, camera.height_px)
        else:
            _check_readable(picture, field)


def _idle(unit: Unit) -> Photo:
    """What a unit shows at rest."""
    from sim.optics.studio.unit_residual import read_unit

    return read_unit(unit).idle


@functools.lru_cache(maxsize=2)
def _check_background(picture: Photo, width_px: int, height_px: int) -> None:
    """Every edit of a design asks: one of 12 million pixels takes a second to decode."""
    from sim.optics.studio.background import photo_light

    photo_light(picture, Camera(width_px=width_px, height_px=height_px))


@functools.lru_cache(maxsize=2)
def _check_readable(picture: Photo, field: str) -> None:
    from sim.optics.raster.photo_file import read_rgb

    read_rgb(picture, at=field)


def take_photos(table: Mapping[str, Any]) -> tuple[dict[str, Any], dict[str, Any]]:
    """A design's table without its pictures, and what it says of them, by field."""
    rest, found = dict(table), {}
    for field in FIELDS:
        *path, last = field.split(".")
        owner: Any = rest
        for step in path:
            inner = owner.get(step)
            if not isinstance(inner, Mapping):
                break
            owner[step] = dict(inner)
            owner = owner[step]
        else:
            if last in owner:
                found[field] = owner.pop(last)
    return rest, found


def with_photos(
    design: SensorDesign, named: Mapping[str, Any], *, roots: Sequence[Path], enclosed: bool = False
) -> SensorDesign:
    """The design with the pictures that `take_photos` found named.

    Raises:
        DesignError: As `read_photo`.
    """
    for field, name in named.items():
        design = design.replace(field, read_photo(name, roots=roots, enclosed=enclosed, at=field))
    return design


def without_photos(design: SensorDesign) -> SensorDesign:
    """The design as numbers and texts only."""
    for field in design_photos(design):
        design = design.replace(field, None)
    return design


def add_names(table: dict[str, Any], design: SensorDesign) -> None:
    """Name the design's pictures in its table, as the project keeps them."""
    for field, picture in design_photos(design).items():
        *path, last = field.split(".")
        owner = table
        for step in path:
            owner = owner[step]
        owner[last] = kept_name(picture)


def design_photos(design: SensorDesign) -> dict[str, Photo | Unit]:
    """The pictures of a design, and its unit, by field."""
    optics = design.optics
    files = optics.background, optics.markers.picture, optics.unit
    held = dict(zip(FIELDS, files, strict=True))
    return {field: picture for field, picture in held.items() if picture is not None}


def kept_name(picture: Photo | Unit) -> str:
    """Where a project keeps a picture, relative to its folder; a shipped one by its own name."""
    for name, shipped in shipped_photos().items():
        if shipped == picture:
            return BUILTIN + name
    return f"{FOLDER}/{picture.sha256[:32]}-{own_name(picture.name)}"


def kept_photos(design: SensorDesign) -> dict[str, bytes]:
    """What a project must hold for a design, by path relative to its folder."""
    named = {kept_name(picture): picture for picture in design_photos(design).values()}
    return {
        name: picture.data.tobytes()
        for name, picture in named.items()
        if not name.startswith(BUILTIN)
    }
