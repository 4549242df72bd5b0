"""A stored result as bytes, for workers that do not see the store of the one who asks."""

from __future__ import annotations

import io
import tarfile
from pathlib import Path

from workbench.core.base.errors import StoreError
from workbench.pipeline.stage import Ref
from workbench.pipeline.store import Store
from workbench.pipeline.write_once import META, part_of, publish


def packed(store: Store, ref: Ref) -> bytes:
    """The files of a stored result.

    Raises:
        StoreError: If the store does not have it.
    """
    folder = store.path(ref.stage, ref.key)
    out = io.BytesIO()
    try:
        with tarfile.open(fileobj=out, mode="w") as archive:
            # The file that says what is there comes last, as it is written.
            for path in sorted(folder.iterdir(), key=lambda path: path.name == META):
                archive.add(path, arcname=path.name)
    except OSError as error:
        raise StoreError(
            f"the stored result {ref.stage}/{ref.key[:12]} cannot be sent: {error}",
            hint="run again: it is then computed anew",
            at=ref.stage,
        ) from error
    return out.getvalue()


def unpacked(store: Store, ref: Ref, content: bytes) -> None:
    """Put a result into a store that lacks it; of two writers the first one wins.

    Raises:
        StoreError: If the store cannot be written, or what came is no result.
    """
    if store.has(ref.stage, ref.key):
        return
    with part_of(store.root, ref.stage) as part:
        with tarfile.open(fileobj=io.BytesIO(content)) as archive:
            archive.extractall(part, filter="data")
        if not (part / META).is_file():
            raise StoreError(
                f"what a worker sent of {ref.stage} is no result",
                hint="the cluster must run the version that asks",
                at=ref.stage,
            )
        publish(part, Path(store.path(ref.stage, ref.key)))
