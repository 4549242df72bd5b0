"""Photographs to be read as a project keeps them, in `reading/photos`, `idle.png` among them."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from workbench.core.base.errors import DesignError
from workbench.core.design.photo import PICTURE_ENDINGS
from workbench.photographs.photo_files import decoded, is_idle
from workbench.report.image_files import png_bytes
from workbench.system.whole_files import free_path, write_atomically

FOLDER, PHOTOS, OUT = "reading", "photos", "out"
IDLE = "idle.png"


class KeptReadings:
    """Those of one project."""

    def __init__(self, project: Path) -> None:
        self.root = project / FOLDER

    @property
    def folder(self) -> Path:
        """Where the photographs lie."""
        return self.root / PHOTOS

    @property
    def out(self) -> Path:
        """Where readings are written, as `workbench read` does."""
        return self.root / OUT

    @property
    def has_idle(self) -> bool:
        """Whether there is a photograph at rest."""
        return (self.folder / IDLE).is_file()

    @property
    def photos(self) -> tuple[str, ...]:
        """Names of the photographs of touch."""
        if not self.folder.is_dir():
            return ()
        names = (path.name for path in self.folder.iterdir() if path.is_file())
        usable = (name for name in names if name.lower().endswith(PICTURE_ENDINGS))
        return tuple(sorted(name for name in usable if not is_idle(name)))

    def image(self, name: str) -> np.ndarray:
        """A photograph, shape (H, W, 3), uint8.

        Raises:
            DesignError: If it is gone or cannot be read.
        """
        try:
            return decoded(name, (self.folder / name).read_bytes())
        except OSError as error:
            raise DesignError(f"{name} cannot be read: {error}", hint="load it again") from error

    def take(self, files: Mapping[str, bytes]) -> tuple[str, ...]:
        """Add files by name, all of them or none; `idle` with any ending is the one at rest.

        Returns:
            Names of the photographs of touch that came.

        Raises:
            DesignError: With the file's name, if it cannot be read or has another size.
            StoreError: If the folder cannot be written.
        """
        pictures = {
            name: decoded(name, content)
            for name, content in files.items()
            if not name.lower().endswith(".csv")
        }
        self._expect_one_size(pictures)
        for name, image in pictures.items():
            if is_idle(name):
                self.rest(image)
            else:
                write_atomically(self.folder / name, files[name])
        return tuple(name for name in pictures if not is_idle(name))

    def rest(self, image: np.ndarray) -> None:
        """Keep a photograph (H, W, 3), uint8, as the one at rest."""
        write_atomically(self.folder / IDLE, png_bytes(image))

    def put_away(self) -> Path | None:
        """Begin anew: what was kept stays beside under another name, which is returned."""
        if not self.root.exists():
            return None
        kept = free_path(self.root.with_name(f"{FOLDER}-before"))
        self.root.replace(kept)
        return kept

    def _expect_one_size(self, pictures: Mapping[str, np.ndarray]) -> None:
        """Refuse pictures of another size than the one at rest."""
        idle = next((image for name, image in pictures.items() if is_idle(name)), None)
        if idle is None and self.has_idle:
            idle = self.image(IDLE)
        for name, image in pictures.items():
            if idle is not None and image.shape != idle.shape:
                sizes = [f"{each.shape[1]} x {each.shape[0]}" for each in (image, idle)]
                raise DesignError(
                    f"{name} has {sizes[0]} pixels, the idle photo {sizes[1]}",
                    hint="take all photographs with the same settings of the camera",
                )
