"""Results that ship: what the first page shows, so that a newcomer sees a contact at once.

`first_results.zip` has the folders of the store for the design that a new project begins with, as
they were computed once; `make first` makes it anew. Results are found by their keys, so an archive
of an older program gives nothing, and `tests/unit/test_first_results.py` says so.
"""

from __future__ import annotations

import lzma
import zipfile
from collections.abc import Mapping
from pathlib import Path, PurePosixPath

from workbench.core.base.errors import StoreError
from workbench.pipeline.store import Store
from workbench.pipeline.write_once import META, part_of, publish, write_file

FILE = Path(__file__).with_name("first_results.zip")
STAGES = ("build", "mesh", "press", "shoot", "maps")
"""What the first page shows; light and lattice are computed once somebody asks for another."""
MOST_BYTES = 10_000_000
"""Size of the archive: it is in every installation."""


def shipped_keys(file: Path = FILE) -> dict[str, str]:
    """Keys of the shipped results by stage; none where there is no archive.

    Raises:
        StoreError: If it is damaged.
    """
    if not file.is_file():
        return {}
    try:
        with zipfile.ZipFile(file) as archive:
            paths = [PurePosixPath(name) for name in archive.namelist()]
    except (OSError, zipfile.BadZipFile) as error:
        raise _damaged(file, error) from error
    return {path.parts[0]: path.parts[1] for path in paths if len(path.parts) == 3}


def unpack_first(store: Store, wanted: Mapping[str, str], file: Path = FILE) -> tuple[str, ...]:
    """Put the shipped results into a store, if all of them are wanted.

    Args:
        store: Where they are missing.
        wanted: Keys by stage of the design and press that are begun with; others have none.
        file: The archive.

    Returns:
        Stages whose results are new in the store.

    Raises:
        StoreError: If the archive is damaged, or the disk full or read-only.
    """
    keys = shipped_keys(file)
    if not keys or any(wanted.get(stage) != key for stage, key in keys.items()):
        return ()
    put = tuple(stage for stage, key in keys.items() if not store.has(stage, key))
    try:
        with zipfile.ZipFile(file) as archive:
            for stage in put:
                with part_of(store.root, stage) as part:
                    _extract(archive, f"{stage}/{keys[stage]}/", part)
                    publish(part, store.path(stage, keys[stage]))
    except (EOFError, lzma.LZMAError, zipfile.BadZipFile) as error:
        raise _damaged(file, error) from error
    return put


def _extract(archive: zipfile.ZipFile, folder: str, part: Path) -> None:
    names = [name for name in archive.namelist() if name.startswith(folder)]
    # What says that the folder is whole comes last.
    for name in sorted(names, key=lambda name: name.endswith(META)):
        content = archive.read(name)
        write_file(part / PurePosixPath(name).name, lambda file, c=content: file.write(c))


def pack_first(store: Store, keys: Mapping[str, str], file: Path = FILE) -> int:
    """Write the archive from a store that has all of `STAGES`; returns its size.

    Raises:
        StoreError: If a result is missing, or the archive is larger than `MOST_BYTES`.
    """
    for stage in STAGES:
        # Says what is missing or damaged.
        store.entry(stage, keys[stage])
    with zipfile.ZipFile(file, "w", zipfile.ZIP_LZMA) as archive:
        for stage in STAGES:
            for path in sorted(store.path(stage, keys[stage]).iterdir()):
                archive.writestr(_dated(f"{stage}/{keys[stage]}/{path.name}"), path.read_bytes())
    size = file.stat().st_size
    if size > MOST_BYTES:
        raise StoreError(
            f"{file.name} has {size / 1e6:.1f} MB, more than {MOST_BYTES / 1e6:g} MB",
            hint="ship fewer stages, or an example of fewer frames",
            at=str(file),
        )
    return size


def _dated(name: str) -> zipfile.ZipInfo:
    """An entry without the time it was written at: the same results make the same archive."""
    entry = zipfile.ZipInfo(name)
    entry.compress_type = zipfile.ZIP_LZMA
    return entry


def _damaged(file: Path, error: Exception) -> StoreError:
    return StoreError(
        f"{file.name} cannot be read: {error}",
        hint="install the workbench again; until then the example is computed",
        at=str(file),
    )
