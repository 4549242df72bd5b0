"""Options of the command line about design, object and press: the same for `run` and `sweep`."""

from __future__ import annotations

import argparse
from pathlib import Path

from workbench.core.design.design import Law, SensorDesign
from workbench.core.design.imported import LengthUnit
from workbench.core.design.lighting import LightModel
from workbench.core.press.motion import Mover
from workbench.core.press.press import Extent, Method

INDENTERS = (
    "sphere, cylinder_end, cylinder_side, cube, cone, cross, triangle, pacman, hexagon, ellipsoid, "
    "double_cylinder, diamond, flower, ring, rhombus, torus; as released with the paper: "
    "released_cube, released_flower ... (docs/contact.md); mug, screwdriver, banana; or the path "
    "of an STL, OBJ or STEP file"
)
TEXTURES = (
    "raised on the object: grid, dots or waves, letters=TEXT, or a picture's path; "
    "PATTERN:HEIGHT:PITCH in mm"
)


def add_unit_option(sub: argparse.ArgumentParser) -> None:
    """The unit of an STL design."""
    sub.add_argument(
        "--unit",
        default="auto",
        choices=[unit.value for unit in LengthUnit],
        help="unit of an STL design (default: inferred from its size)",
    )


def add_set_option(sub: argparse.ArgumentParser) -> None:
    """Fields of the design, as often as one likes."""
    text = "any field of the design, for example material.friction=0.5; may be given several times"
    sub.add_argument("--set", action="append", default=[], metavar="FIELD=VALUE", help=text)


def add_fit_option(sub: argparse.ArgumentParser) -> None:
    """Places that a body does not have, changed instead of refused."""
    text = "bring LEDs, lamps and cameras inside the body where they are not"
    sub.add_argument("--fit", action="store_true", help=text)


def add_press_options(sub: argparse.ArgumentParser) -> None:
    """What is pressed, where, how it moves and how it is computed; none has a default here."""
    _object_options(sub)
    _path_options(sub)
    _solver_options(sub)
    add_set_option(sub)
    sub.add_argument("--material-law", choices=[law.value for law in Law], help="of the design")
    models = [model.value for model in LightModel]
    sub.add_argument("--light-model", choices=models, help="of the design")
    text = "a bought camera: its pixels, lens and size (docs/parts.md)"
    sub.add_argument("--camera", metavar="NAME", help=text)
    text = "bought LEDs of the ring, one or one for each sector: colour, lobe, size (docs/parts.md)"
    sub.add_argument("--led", metavar="NAME,...", help=text)


def _object_options(sub: argparse.ArgumentParser) -> None:
    sub.add_argument("--indenter", help=f"{INDENTERS} (default sphere)")
    sub.add_argument("--size-mm", type=float, help="diameter, else the largest width (default 6)")
    sub.add_argument(
        "--edge-radius-mm", type=float, help="rounding of edges (default 0.45; of a file 0)"
    )
    sub.add_argument("--texture", metavar="PATTERN", help=TEXTURES)
    text = "turn it about the fixed X, then Y, then Z; its -Z side meets the skin (default 0,0,0)"
    sub.add_argument("--turn-deg", metavar="X,Y,Z", help=text)
    sub.add_argument("--soft-mpa", type=float, help="Young's modulus of a soft object [MPa]")


def _path_options(sub: argparse.ArgumentParser) -> None:
    sub.add_argument("--target", help="x,y,z near the skin [mm] (default: where the family says)")
    text = "from first touch along the inward normal (default 1, or that of the sequence)"
    sub.add_argument("--depth-mm", type=float, help=text)
    text = "along the skin at full depth: U is +Z in the tangent plane, V is across (default 0,0)"
    sub.add_argument("--shear-mm", metavar="U,V", help=text)
    sub.add_argument("--twist-deg", type=float, help="about the normal at full depth (default 0)")
    text = (
        "of the approach; shear and twist take as many (default 10; of a sequence 5 to each phase)"
    )
    sub.add_argument("--frames", type=int, help=text)
    sub.add_argument("--sequence", metavar="NAME", help="what driven parts do: grip of the trunk")
    sub.add_argument(
        "--stroke",
        action="append",
        default=[],
        metavar="KIND:AMOUNT[:FRAMES]",
        help="a move after the approach; may be given several times (docs/contact.md)",
    )
    sub.add_argument(
        "--trajectory", type=Path, metavar="FILE.csv", help="timed poses, a path of their own"
    )
    text = "time between frames of a trajectory (default: every row is one)"
    sub.add_argument("--every-s", type=float, help=text)
    text = "which of the two a trajectory moves in the room (default object)"
    sub.add_argument("--mover", choices=[m.value for m in Mover], help=text)
    text = "where the object stands while the sensor moves (default: at the target)"
    sub.add_argument("--object-pose", metavar="X,Y,Z,QW,QX,QY,QZ", help=text)


def _solver_options(sub: argparse.ArgumentParser) -> None:
    sub.add_argument("--grid-mm", type=float, help="grid cell of the contact solver (default 0.5)")
    text = "the region around the contact, or the whole membrane (default active)"
    sub.add_argument("--extent", choices=[e.value for e in Extent], help=text)
    sub.add_argument(
        "--region-error", type=float, help="what the region may cost of the force (default 0.003)"
    )
    text = "the workbench's own, or the published one to compare with (default lattice)"
    sub.add_argument("--method", choices=[m.value for m in Method], help=text)
    sub.add_argument("--max-substeps", type=int, help="of a frame before giving up (default 6000)")
    sub.add_argument("--tolerance", type=float, help="residual that has settled (default 0.001)")
    sub.add_argument("--penalty", type=float, help="contact stiffness, E / grid (default 200)")


def changed_design(options: argparse.Namespace, design: SensorDesign) -> SensorDesign:
    """The design with the parts, fields, light model and material's law that the options name.

    Fields that are set come after what a bought part brings.

    Raises:
        DesignError: If there is no such field, or the design does not take its value.
    """
    from workbench.edit.catalogue import with_camera, with_leds
    from workbench.edit.typed_fields import with_typed

    if options.camera:
        design = with_camera(design, options.camera)
    if options.led:
        design = with_leds(design, options.led.split(","))
    design = with_typed(design, options.set)
    if options.light_model:
        design = design.replace("optics.light_model", LightModel(options.light_model))
    if options.material_law:
        design = design.replace("material.law", Law(options.material_law))
    return design
