"""A design as one file: readable TOML alone, or a zip of it with the files that it names.

A zip holds one TOML at its top and beside it `bodies/`, `pictures/` and `indenters/`, as the
project's folder does. What a zip holds is checked by name, size and number and unpacked into a
folder of its own; the readers check the contents.
"""

from __future__ import annotations

import dataclasses
import io
import re
import tempfile
import zipfile
from collections.abc import Mapping
from pathlib import Path

from workbench.core.base.errors import DesignError
from workbench.pipeline.chosen_weights import from_project
from workbench.project.design_toml import design_files, design_to_toml
from workbench.project.kept_indenters import kept_arrays
from workbench.project.project import Project
from workbench.project.state import State, case_table, read_state
from workbench.system.uploads import own_name
from workbench.system.whole_files import MAX_TOML_BYTES
from workbench.system.zip_files import zip_members

MOST_FILES = 50
MOST_BYTES = 200_000_000
"""Unpacked."""
MEMBER = re.compile(r"(bodies|pictures|indenters)/[A-Za-z0-9][A-Za-z0-9._-]{0,120}")
ZIP_START = b"PK\x03\x04"


def bundle(state: State, project: Project) -> tuple[str, bytes]:
    """Name and content of the file that holds all of a design and its press.

    Raises:
        StoreError: If a file of it cannot be kept in the project.
    """
    design = state.design
    project.keep_files(design)
    table = case_table(state.case, project)
    text = design_to_toml(design, press_case=table).encode()
    files = design_files(design) | kept_arrays(table["indenter"], project)
    if not files:
        return f"{design.name}.toml", text
    return f"{design.name}.zip", zipped({f"{own_name(design.name)}.toml": text, **files})


def unbundle(name: str, content: bytes, project: Project) -> State:
    """The design and press of a file; what it brings with it is kept in the project.

    Args:
        name: Of the file, for messages.
        content: TOML as UTF-8, or a zip.
        project: Where its files are kept.

    Raises:
        DesignError: If it is too large, broken, or holds what does not belong there.
        StoreError: If the project cannot be written.
    """
    if not content.startswith(ZIP_START):
        return read_state(_text(name, content), project, source=name, enclosed=True)
    with tempfile.TemporaryDirectory() as folder:
        text = _unpacked(name, content, Path(folder))
        # Read once where only its own files are, so that a broken zip leaves nothing behind.
        state = read_state(text, Project(folder), source=name, enclosed=True)
    project.keep_files(state.design)
    case_table(state.case, project)
    # A zip brings no weights: those that it names are looked for in the project that it came to.
    learned = from_project(state.case.learned, project.folder, enclosed=True)
    return dataclasses.replace(state, case=dataclasses.replace(state.case, learned=learned))


def zipped(files: Mapping[str, bytes]) -> bytes:
    """Files by their path inside a zip archive."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in files.items():
            archive.writestr(name, content)
    return buffer.getvalue()


def _text(name: str, content: bytes) -> str:
    if len(content) > MAX_TOML_BYTES:
        raise DesignError(
            f"{name} has {len(content)} bytes, a design at most {MAX_TOML_BYTES}",
            hint="choose a TOML file or a zip saved by the workbench",
            at="design",
        )
    try:
        return content.decode("utf-8")
    except UnicodeDecodeError as error:
        raise DesignError(
            f"{name} is not UTF-8 text", hint="choose a TOML file or a zip of one", at="design"
        ) from error


def _unpacked(name: str, content: bytes, folder: Path) -> str:
    """Write a zip's files into a folder; returns its TOML."""
    files = zip_members(name, content, wanted=_wanted, most_files=MOST_FILES, most_bytes=MOST_BYTES)
    texts = [path for path in files if not MEMBER.fullmatch(path)]
    if len(texts) != 1:
        raise DesignError(
            f"{name} holds {len(texts)} TOML files at its top, expected 1",
            hint="choose a zip that Download design has written",
            at="design",
        )
    for path in files.keys() - texts:
        target = folder / path
        target.parent.mkdir(exist_ok=True)
        target.write_bytes(files[path])
    return _text(name, files[texts[0]])


def _wanted(path: str) -> bool:
    """Whether a member is the design itself, or a file that it may name."""
    return bool(MEMBER.fullmatch(path)) or ("/" not in path and path.lower().endswith(".toml"))
