"""A design as one file: readable TOML alone, or a zip of it with the files that it names.

A zip holds one TOML at its top and beside it `bodies/`, `pictures/` and `indenters/`, as the
project's folder does. What a zip holds is checked by name, size and number before it is unpacked,
into a folder of its own; the readers check the contents.
"""

from __future__ import annotations

import io
import re
import tempfile
import zipfile
import zlib
from collections.abc import Mapping
from pathlib import Path

from workbench.core.errors import DesignError
from workbench.kept_indenters import kept_arrays
from workbench.project import MAX_TOML_BYTES, Project, design_files, design_to_toml
from workbench.state import State, case_table, read_state
from workbench.uploads import own_name

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
    return state


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
    try:
        with zipfile.ZipFile(io.BytesIO(content)) as archive:
            members = archive.infolist()
            _check(name, members)
            for member in members:
                if MEMBER.fullmatch(member.filename):
                    path = folder / member.filename
                    path.parent.mkdir(exist_ok=True)
                    path.write_bytes(archive.read(member))
            return _text(name, archive.read(_tomls(members)[0]))
    except (zipfile.BadZipFile, zlib.error, EOFError, NotImplementedError, RuntimeError) as error:
        raise DesignError(
            f"{name} is not a zip that can be read: {error}", hint="save it again", at="design"
        ) from error


def _tomls(members: list[zipfile.ZipInfo]) -> list[str]:
    names = (member.filename for member in members)
    return [name for name in names if "/" not in name and name.lower().endswith(".toml")]


def _check(name: str, members: list[zipfile.ZipInfo]) -> None:
    total = sum(member.file_size for member in members)
    if len(members) > MOST_FILES or total > MOST_BYTES:
        raise DesignError(
            f"{name} unpacks to {len(members)} files of {total / 1e6:.0f} MB, a design has at most "
            f"{MOST_FILES} and {MOST_BYTES / 1e6:.0f} MB",
            hint="is this a design saved by the workbench?",
            at="design",
        )
    if len(_tomls(members)) != 1:
        raise DesignError(
            f"{name} holds {len(_tomls(members))} TOML files at its top, expected 1",
            hint="choose a zip that Download design has written",
            at="design",
        )
