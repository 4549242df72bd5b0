"""A project folder (store, designs, crash files) and designs as TOML with a schema number.

```
.workbench/
  store/     results by stage and key
  designs/   autosave.toml
  variants/  kept designs with their press, figures and thumbnails; `trash/` has deleted ones
  sweeps/    one-parameter sweeps with their figures
  bodies/    files of imported bodies by hash
  pictures/  backgrounds and patterns of markers by hash
  indenters/ meshes of STL indenters by key
  crash/     one file per bug that reached the edge
```
"""

from __future__ import annotations

import contextlib
import dataclasses
import itertools
import os
import secrets
import time
import tomllib
from collections.abc import Mapping, Sequence
from importlib import resources
from pathlib import Path
from typing import Any

from workbench.bodies import (
    ENDINGS,
    body_table,
    check_body,
    design_of_file,
    kept_files,
    read_body_table,
    without_body,
)
from workbench.core.design import SCHEMA, SensorDesign
from workbench.core.errors import DesignError, StoreError
from workbench.core.mapping import from_table, suggest, to_table
from workbench.moduli import with_moduli
from workbench.photos import (
    add_names,
    check_photos,
    kept_photos,
    take_photos,
    with_photos,
    without_photos,
)
from workbench.store import Store

VARIABLE = "WORKBENCH_PROJECT"
DEFAULT_FOLDER = ".workbench"
AUTOSAVE = "autosave"
MAX_TOML_BYTES = 1_000_000
MOST_NAME_BYTES = 240
"""Of a file's name; a file system takes 255, and some go to its ending."""
RESERVED = ("-",)
"""Names that mean none in the lists of the front."""
GUEST_TABLES = ("press_case", "variant", "sweep")
"""Tables of a design file that the design itself does not read."""


class Project:
    """Where a designer's work lives."""

    def __init__(self, folder: Path | str | None = None) -> None:
        self.folder = Path(folder or os.environ.get(VARIABLE) or DEFAULT_FOLDER).resolve()
        self.store = Store(self.folder / "store")

    def design_path(self, name: str) -> Path:
        """File of a saved design.

        Raises:
            DesignError: If the name cannot be one of a file, or could leave the folder.
        """
        if not _fits(name):
            raise DesignError(
                f"{name!r} cannot be a design name",
                hint="use letters, digits, spaces and dashes, at most 80",
                at="name",
            )
        return self.folder / "designs" / f"{name}.toml"

    def save_design(self, name: str, design: SensorDesign, **extra: Any) -> Path:
        """Write a design by atomic replacement; `extra` tables are kept beside it."""
        path = self.design_path(name)
        self.keep_files(design)
        write_atomically(path, (design_to_toml(design, **extra)).encode())
        return path

    def keep_files(self, design: SensorDesign) -> None:
        """Keep the files that a design is made of; each is written once.

        Raises:
            StoreError: If the project folder cannot be written.
        """
        for name, content in design_files(design).items():
            if not (self.folder / name).exists():
                write_atomically(self.folder / name, content)

    def keep_aside(self, name: str) -> Path:
        """Copy a design file that cannot be read to a free name beside it; returns that file.

        Raises:
            StoreError: If the folder cannot be written.
        """
        path = self.design_path(name)
        kept = _free(path.with_name(f"{path.stem}-broken{path.suffix}"))
        try:
            content = path.read_bytes()
        except OSError as error:
            raise StoreError(
                f"cannot read {path}: {error.strerror or error}",
                hint="check the file and its permissions",
                at=str(path),
            ) from error
        write_atomically(kept, content)
        return kept

    def write_crash(self, text: str) -> Path:
        """Keep a traceback for a bug report; returns the file."""
        name = f"{time.strftime('%Y%m%d-%H%M%S')}-{os.getpid()}.txt"
        # Two bugs in one second, or in an hour that a clock set back lives twice.
        path = _free(self.folder / "crash" / name)
        write_atomically(path, text.encode())
        return path


def _fits(name: str) -> bool:
    """Whether every file system takes a name, and no other file has it."""
    if not name or name != name.strip() or name[0] == "." or not name.isprintable():
        return False
    if len(name) > 80 or len(name.encode()) > MOST_NAME_BYTES or name in RESERVED:
        return False
    # Some disks do not tell capital letters from small ones.
    own = name.lower() == AUTOSAVE and name != AUTOSAVE
    return not own and not any(letter in name for letter in '/\\:*?"<>|')


def _free(path: Path) -> Path:
    """The path, or the first of it with a number that is not taken."""
    numbered = (
        path.with_name(f"{path.stem}-{number}{path.suffix}") for number in itertools.count(2)
    )
    return next(free for free in itertools.chain((path,), numbered) if not free.exists())


def kept_text(path: Path) -> str:
    """The text of a file of the project that people may have edited.

    Raises:
        OSError: If it cannot be read.
        ValueError: If it is larger than a design may be, or not UTF-8.
    """
    if path.stat().st_size > MAX_TOML_BYTES:
        raise ValueError(f"it is larger than {MAX_TOML_BYTES} bytes")
    return path.read_text(encoding="utf-8")


def write_atomically(path: Path, content: bytes) -> None:
    """Replace a file so that a reader sees the old or the new one, never a part.

    Raises:
        StoreError: If the disk is full or read-only; the old file stays.
    """
    part = path.with_name(f".part-{os.getpid()}-{secrets.token_hex(6)}")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with part.open("xb") as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        part.replace(path)
    except OSError as error:
        with contextlib.suppress(OSError):
            part.unlink()
        raise StoreError(
            f"cannot write {path}: {error.strerror or error}",
            hint="free some space or choose a writable folder; the old file is kept",
            at=str(path),
        ) from error


def presets() -> dict[str, str]:
    """Name and one-line purpose of each shipped design."""
    found = {}
    for file in sorted(_preset_folder().iterdir(), key=lambda f: f.name):
        if file.name.endswith(".toml"):
            text = file.read_text()
            found[file.name[:-5]] = text.splitlines()[0].lstrip("# ")
    return found


def _preset_folder() -> Any:
    return resources.files("designs") / "presets"


def load_design(name: str, *, unit: str = "auto", project: Project | None = None) -> SensorDesign:
    """A preset by name, else a family with its defaults, else a TOML, STL or STEP file.

    Args:
        name: Name or path.
        unit: Unit of an STL file.
        project: Where the files of a design's body may be kept, besides the design's own folder.

    Raises:
        DesignError: If there is no such preset, family or file, or the file is not valid.
    """
    from designs.family import families

    if name in presets():
        return design_from_toml((_preset_folder() / f"{name}.toml").read_text(), source=name)
    if name in families():
        return SensorDesign(name=name, family=name)
    if name.lower().endswith(ENDINGS):
        return design_of_file(Path(name), unit)
    if name.endswith(".toml") or os.sep in name:
        path = Path(name)
        kept = () if project is None else (project.folder,)
        beside = path.absolute().parent
        roots = (beside, beside.parent, *kept)
        return design_from_toml(_read(path), source=name, roots=roots)
    raise DesignError(
        f"there is no preset, family, TOML, STL or STEP file named {name!r}",
        hint=suggest(name, {*presets(), *families()}),
        at="design",
    )


def _read(path: Path) -> str:
    try:
        size = path.stat().st_size
        if size > MAX_TOML_BYTES:
            raise DesignError(
                f"{path} has {size} bytes, a design has at most {MAX_TOML_BYTES}",
                hint="is this really a design file?",
                at="design",
            )
        return path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise DesignError(
            f"cannot read {path}: {getattr(error, 'strerror', None) or error}",
            hint="give the path of a readable UTF-8 TOML file",
            at="design",
        ) from error


def design_from_toml(
    text: str, *, source: str = "the file", roots: Sequence[Path] = (), enclosed: bool = False
) -> SensorDesign:
    """Parse and check a design; tables that belong to a session or variant are left out.

    Args:
        text: The file.
        source: Its name, for messages.
        roots: Folders in which the files of an imported body and of pictures are looked for.
        enclosed: Whether they must lie inside these: for a design that somebody else may have made.

    Raises:
        DesignError: For broken TOML, a newer schema, unknown fields or refused values.
    """
    table = parse_toml(text, source=source)
    own = {name: value for name, value in table.items() if name not in GUEST_TABLES}
    body = own.pop("body", None)
    if "material" in own:
        own["material"] = with_moduli(own["material"])
    own, pictures = take_photos(own)
    design = from_table(SensorDesign, own)
    design = with_photos(design, pictures, roots=roots, enclosed=enclosed)
    if body is not None:
        read = read_body_table(body, roots=roots, enclosed=enclosed)
        design = dataclasses.replace(design, body=read)
    check_design(design)
    return design


def parse_toml(text: str, *, source: str) -> Mapping[str, Any]:
    """The tables of a design file, its schema checked.

    Raises:
        DesignError: For broken TOML or a newer schema.
    """
    try:
        table = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise DesignError(
            f"{source} is not valid TOML: {error}", hint="correct the line named", at="design"
        ) from error
    schema = table.get("schema", SCHEMA)
    if not isinstance(schema, int) or isinstance(schema, bool) or schema < 1:
        raise DesignError(
            f"{source} has schema {schema!r}", hint=f"write schema = {SCHEMA}", at="schema"
        )
    if schema > SCHEMA:
        raise DesignError(
            f"{source} has schema {schema}, this program reads up to {SCHEMA}",
            hint="update the workbench, or save the design with the older version",
            at="schema",
        )
    return table


def check_design(design: SensorDesign) -> None:
    """Check what needs files or the family: its shape parameters and their fit with the layers.

    Raises:
        DesignError: Naming the field.
    """
    from designs.family import family, resolve_shape
    from geometry.silicones import silicone
    from sim.optics.places import check_lenses

    check_body(design)
    check_photos(design)
    check_lenses(design.optics)
    family(design.family).check(resolve_shape(design.family, design.shape), design.layers)
    silicone(design.casting.silicone)


def design_to_toml(design: SensorDesign, **extra: Any) -> str:
    """A design as readable TOML; `design_from_toml` gives the same design back."""
    import tomli_w

    return tomli_w.dumps({**design_table(design), **to_table(extra)})


def design_table(design: SensorDesign) -> dict[str, Any]:
    """A design as nested tables, an imported body and pictures by the names of their files."""
    table = to_table(without_photos(without_body(design)))
    add_names(table, design)
    return table if design.body is None else {**table, "body": body_table(design.body)}


def design_files(design: SensorDesign) -> dict[str, bytes]:
    """The files that a design's table names, by path relative to the project's folder."""
    bodies = {} if design.body is None else kept_files(design.body)
    return bodies | kept_photos(design)
