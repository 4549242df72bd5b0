"""The thumbnails of the galleries, shipped with the designs and drawn by `docs/thumbnails.py`.

`keys.toml` beside them says what each was drawn of: the key of a body, or the digest of an object.
"""

from __future__ import annotations

import tomllib
from importlib import resources
from pathlib import Path

from workbench.core.base.digest import digest
from workbench.core.press.indenter import Indenter
from workbench.core.press.press_case import PressCase
from workbench.edit.indenter_edit import another
from workbench.planning.plan import plan
from workbench.project.named_designs import load_design

FOLDER = Path("designs") / "thumbnails"
KEYS = "keys.toml"


def shipped_thumbnail(name: str) -> bytes | None:
    """A shipped thumbnail, for example of `start-finger` or `object-cube`; None where none is."""
    file = resources.files("designs") / "thumbnails" / f"{name}.png"
    return file.read_bytes() if file.is_file() else None


def shipped_keys() -> dict[str, str]:
    """What each shipped thumbnail was drawn of."""
    return tomllib.loads(
        (resources.files("designs") / "thumbnails" / KEYS).read_text(encoding="utf-8")
    )


def start_key(name: str) -> str:
    """The key of the body of a preset or family as it stands today."""
    return plan(load_design(name), PressCase())["build"].key


def object_key(name: str) -> str:
    """The digest of an object of the studio's gallery as it stands today."""
    return digest(another(name, Indenter()))
