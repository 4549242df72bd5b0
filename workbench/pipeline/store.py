"""Results on disk: write-once folders `<root>/<stage>/<key>/*.npy` with a `meta.json`.

Whoever sees the folder of a result sees all of it (`workbench.pipeline.write_once`), and of two
writers the first one wins. Arrays are memory-mapped when loaded, so the
browser process never reads what it does not show; those that are mostly zeros are packed
(`workbench.pipeline.sparse`), and unpacked when loaded.

A result that cannot be read (a torn disk, an editor in the wrong folder) is moved to `damaged/`
and is then as good as none: whoever needs it computes it again.
"""

from __future__ import annotations

import contextlib
import errno
import json
import os
import secrets
import shutil
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from workbench.core.base.codec import pack, unpack
from workbench.core.base.errors import DamagedError, StoreError, shortened
from workbench.pipeline.sparse import PARTS, mostly_zeros, pack_zeros, unpack_zeros
from workbench.pipeline.write_once import META, discard, part_of, publish, write_file
from workbench.system.terminal import complain
from workbench.system.unfinished import UNFINISHED, is_left_behind

DAMAGED = "damaged"
"""Folder of what could not be read, for whoever wants to know why."""
DAMAGED_KEPT = 10
"""So many of them, the newest."""
TORN = (errno.ENOENT, errno.EIO)
"""What the system says of a result that is not whole; anything else is no fault of the result."""
DEFAULT_LIMIT_BYTES = 20 * 2**30
"""Size at which the least recently used results go."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Entry:
    """One stored result."""

    stage: str
    key: str
    seconds: float
    """Time the computation took [s]."""
    bytes: int


class Store:
    """A folder of results, shared by all processes of a project."""

    def __init__(self, root: Path | str, *, limit_bytes: int = DEFAULT_LIMIT_BYTES) -> None:
        self.root = Path(root)
        self.limit_bytes = limit_bytes
        self.on_message: Callable[[str], None] = complain
        """Who hears that a result was set aside."""
        self._sound: dict[Path, int] = {}
        """When the results that were looked into had been written [ns]."""

    def path(self, stage: str, key: str) -> Path:
        """Folder of a result, whether it exists or not."""
        return self.root / stage / key

    def has(self, stage: str, key: str) -> bool:
        """Whether the whole result is there; a damaged one is set aside, and is not.

        Every array's header and length are looked at, once for each result.
        """
        meta = self.path(stage, key) / META
        try:
            written_ns = meta.stat().st_mtime_ns
        except OSError:
            return False
        if self._sound.get(meta.parent) == written_ns:
            return True
        try:
            self._arrays(stage, key, self._meta(stage, key))
        except StoreError:
            return False
        self._sound[meta.parent] = written_ns
        return True

    def entry(self, stage: str, key: str) -> Entry:
        """What is known of a stored result."""
        meta = self._meta(stage, key)
        return Entry(stage=stage, key=key, seconds=meta["seconds"], bytes=meta["bytes"])

    def load(self, stage: str, key: str) -> Any:
        """The stored dataclass, arrays read-only and memory-mapped unless packed.

        Raises:
            DamagedError: If it cannot be read; it is set aside then, and said.
            StoreError: If it is missing.
        """
        meta = self._meta(stage, key)
        arrays = self._arrays(stage, key, meta)
        try:
            value = unpack(arrays, meta["tree"])
        except (ValueError, LookupError, TypeError, AttributeError, RecursionError) as error:
            raise self._set_aside(stage, key, error) from error
        with contextlib.suppress(OSError):
            self._touch(self.path(stage, key) / META)
        return value

    def save(self, stage: str, key: str, value: Any, *, seconds: float, version: int) -> None:
        """Write a result once; a second writer of the same key is ignored.

        Raises:
            StoreError: If the disk is full or read-only; nothing half-written is left.
        """
        arrays, tree = pack(value)
        packed = {name: pack_zeros(a) for name, a in arrays.items() if mostly_zeros(a)}
        files = {
            **{f"{name}.npy": a for name, a in arrays.items() if name not in packed},
            **{f"{name}.{end}.npy": a for name, both in packed.items() for end, a in both.items()},
        }
        size = sum(a.nbytes for a in files.values())
        meta = {
            "stage": stage,
            "version": version,
            "seconds": seconds,
            "bytes": size,
            "arrays": sorted(arrays),
            "packed": {name: list(arrays[name].shape) for name in sorted(packed)},
            "tree": tree,
        }
        with part_of(self.root, stage) as part:
            for name, array in files.items():
                write_file(part / name, lambda file, a=array: np.save(file, a))
            write_file(part / META, lambda file: file.write(json.dumps(meta).encode()))
            publish(part, self.path(stage, key))

    def _meta(self, stage: str, key: str) -> dict[str, Any]:
        try:
            meta = json.loads((self.path(stage, key) / META).read_bytes())
            whole = {"seconds", "bytes", "arrays", "tree"} <= set(meta)
            if not (whole and isinstance(meta["bytes"], int)):
                raise ValueError("its description is not whole")
            return meta
        except FileNotFoundError as error:
            raise StoreError(
                f"there is no stored result {stage}/{key}",
                hint="run the stage again; it will be computed anew",
                at=stage,
            ) from error
        except (OSError, ValueError, TypeError) as error:
            raise self._set_aside(stage, key, error) from error

    def _arrays(self, stage: str, key: str, meta: dict[str, Any]) -> dict[str, np.ndarray]:
        """The arrays of a result, mapped unless packed."""
        folder = self.path(stage, key)
        try:
            return {name: _read(folder, name, meta) for name in meta["arrays"]}
        except (OSError, EOFError, ValueError, KeyError, TypeError) as error:
            raise self._set_aside(stage, key, error) from error

    def _set_aside(self, stage: str, key: str, error: Exception) -> StoreError:
        """Move a result that cannot be read out of the way, say so, and return what to raise."""
        if isinstance(error, OSError) and error.errno not in TORN:
            return StoreError(
                f"the stored result {stage}/{key} cannot be read: {error.strerror}",
                hint="close other programs, or check the permissions of the project folder",
                at=stage,
            )
        folder = self.path(stage, key)
        aside = self.root / DAMAGED / f"{stage}-{key}-{secrets.token_hex(3)}"
        self._sound.pop(folder, None)
        try:
            aside.parent.mkdir(exist_ok=True)
            folder.rename(aside)
        except FileNotFoundError:
            # Another process was faster: it has said so.
            pass
        except OSError as stuck:
            return StoreError(
                f"the stored result {stage}/{key} is damaged ({shortened(str(error))}) and cannot "
                f"be moved away: {stuck.strerror}",
                hint=f"check the permissions of {self.root}, or choose another project",
                at=stage,
            )
        else:
            self.on_message(
                f"notice: the stored result {stage}/{key[:12]} was damaged "
                f"({shortened(str(error))}); it is now in {aside} and is computed again"
            )
        return DamagedError(
            f"the stored result {stage}/{key} was damaged and has been set aside",
            hint="run again: it is then computed anew",
            at=stage,
        )

    def _touch(self, meta: Path) -> None:
        """Note that a result was used, without looking into it again for that."""
        os.utime(meta)
        if meta.parent in self._sound:
            self._sound[meta.parent] = meta.stat().st_mtime_ns

    def sweep(self) -> int:
        """Remove what dead writers left behind, then the oldest results beyond the size limit.

        Returns:
            Folders removed.
        """
        removed = 0
        for part in self.root.glob(f"*/{UNFINISHED}"):
            if is_left_behind(part):
                shutil.rmtree(part, ignore_errors=True)
                removed += 1
        entries: list[tuple[float, int, Path]] = []
        for meta in self.root.glob(f"*/*/{META}"):
            if meta.parent.parent.name == DAMAGED:
                continue
            # What is damaged is set aside, with a word, by whoever asks for it.
            with contextlib.suppress(OSError, ValueError, KeyError, TypeError):
                size = int(json.loads(meta.read_bytes())["bytes"])
                entries.append((meta.stat().st_mtime, size, meta.parent))
        aside = sorted((self.root / DAMAGED).glob("*"), key=lambda folder: folder.stat().st_mtime)
        for folder in aside[:-DAMAGED_KEPT]:
            shutil.rmtree(folder, ignore_errors=True)
            removed += 1
        total = sum(size for _, size, _ in entries)
        for _, size, folder in sorted(entries, key=lambda item: item[0]):
            if total <= self.limit_bytes:
                break
            with contextlib.suppress(OSError):
                discard(folder)
                total -= size
                removed += 1
        return removed


def timed(function: Any, *args: Any, **keywords: Any) -> tuple[Any, float]:
    """The result of a call and the seconds it took."""
    start = time.perf_counter()
    value = function(*args, **keywords)
    return value, time.perf_counter() - start


def _read(folder: Path, name: str, meta: dict[str, Any]) -> np.ndarray:
    """One array of a result; results from before arrays were packed have none that are."""
    shape = meta.get("packed", {}).get(name)
    if shape is None:
        return np.load(folder / f"{name}.npy", mmap_mode="r")
    parts = {end: np.load(folder / f"{name}.{end}.npy") for end in PARTS}
    return unpack_zeros(parts, tuple(shape))
