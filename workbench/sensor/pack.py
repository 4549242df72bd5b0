"""A pack: everything that a sensor needs in a loop, in one folder that a small install can open.

    pack.json       version, design, units, what was left out, how well forces agree
    design.toml     the design
    contact.npz     the condensed skin, how it hardens, how what is drawn follows it
    images.npz      rays, light and background
    outer.stl ...   meshes
    LICENSE         of the program that made it

Arrays are as the store's; `pack.json` holds the tree of the dataclasses around them.
"""

from __future__ import annotations

import dataclasses
import io
import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from sim.condensed.assemble import NOTHING
from sim.condensed.surface import Surface
from workbench.core.base.codec import pack as packed
from workbench.core.base.codec import unpack
from workbench.core.base.errors import DesignError
from workbench.core.base.version import VERSION
from workbench.core.design.design import Elastomer
from workbench.core.result.condensed import CondensedSkin, Hardening
from workbench.sensor.halves import halved, made_whole
from workbench.system.whole_files import write_atomically

FORMAT = 1
"""Raised where an older program could not read what is written."""
HEAD, CONTACT, IMAGES, DESIGN = "pack.json", "contact.npz", "images.npz", "design.toml"
HALF = "compliance."
AT = "pack"


@dataclass(frozen=True, kw_only=True)
class Pack:
    """What is in one."""

    name: str
    design_toml: str
    skin: CondensedSkin
    law: Hardening
    material: Elastomer
    surface: Surface
    """How the seen skin's vertices follow the nodes."""
    images: dict[str, np.ndarray]
    """State of the imager."""
    rest_depth_mm: np.ndarray
    """Depth of the untouched skin along the camera's axis, shape (H, W), float32; NaN."""
    left_out: tuple[str, ...] = ()
    """What the design's camera does that these images do not show."""


def is_pack(path: Path) -> bool:
    """Whether a folder looks like one."""
    return (path / HEAD).is_file()


def write_pack(pack: Pack, folder: Path, others: dict[str, bytes]) -> list[Path]:
    """Write a pack, and files beside it by name; returns the paths.

    Raises:
        StoreError: If a file cannot be written.
    """
    # In place of the compliance, whose halves are written.
    bare = dataclasses.replace(pack.skin, compliance=NOTHING)
    arrays, tree = packed({"skin": bare, "law": pack.law, "material": pack.material})
    contact = {
        **arrays,
        **{f"{HALF}{name}": array for name, array in halved(pack.skin.compliance).items()},
        "surface.nodes": pack.surface.nodes,
        "surface.weights": pack.surface.weights,
        "rest_depth_mm": pack.rest_depth_mm,
    }
    head: dict[str, Any] = {
        "format": FORMAT,
        "made_by": f"sensor workbench {VERSION}",
        "name": pack.name,
        "units": {"length": "mm", "force": "N", "torque": "N mm", "pressure": "MPa"},
        "poses": "x, y, z [mm], qw, qx, qy, qz of the object in the sensor's frame",
        "image_px": list(pack.rest_depth_mm.shape[::-1]),
        "largest_force_errors": pack.law.errors or {},
        "left_out": list(pack.left_out),
        "tree": tree,
    }
    files = {
        DESIGN: pack.design_toml.encode(),
        CONTACT: _npz(contact),
        IMAGES: _npz(pack.images),
        **others,
        # Last: a folder without it is no pack.
        HEAD: f"{json.dumps(head, indent=1, allow_nan=False)}\n".encode(),
    }
    folder.mkdir(parents=True, exist_ok=True)
    (folder / HEAD).unlink(missing_ok=True)
    for name, content in files.items():
        write_atomically(folder / name, content)
    return [folder / name for name in files]


def read_pack(folder: Path) -> Pack:
    """A pack from its folder.

    Raises:
        DesignError: If it is none, of another format, or damaged.
    """
    again = "write it anew: workbench export DESIGN --pack DIR"
    try:
        head = json.loads((folder / HEAD).read_bytes())
        made = head["format"]
        if made != FORMAT:
            raise DesignError(
                f"the pack {folder} has format {made}; this program reads {FORMAT}",
                hint=again,
                at=AT,
            )
        contact = _arrays(folder / CONTACT)
        found = unpack(contact, head["tree"])
        half = {
            name.removeprefix(HALF): array
            for name, array in contact.items()
            if name.startswith(HALF)
        }
        return Pack(
            name=head["name"],
            design_toml=(folder / DESIGN).read_text(encoding="utf-8"),
            skin=dataclasses.replace(found["skin"], compliance=made_whole(half)),
            law=found["law"],
            material=found["material"],
            surface=Surface(nodes=contact["surface.nodes"], weights=contact["surface.weights"]),
            images=_arrays(folder / IMAGES),
            rest_depth_mm=contact["rest_depth_mm"],
            left_out=tuple(head["left_out"]),
        )
    except (OSError, ValueError, LookupError, TypeError) as error:
        raise DesignError(
            f"the pack {folder} cannot be read: {error}", hint=again, at=AT
        ) from error


def _npz(arrays: dict[str, np.ndarray]) -> bytes:
    out = io.BytesIO()
    np.savez_compressed(out, **arrays)  # pyright: ignore[reportArgumentType]
    return out.getvalue()


def _arrays(path: Path) -> dict[str, np.ndarray]:
    with np.load(path, allow_pickle=False) as held:
        return {name: held[name] for name in held.files}
