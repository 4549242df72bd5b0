"""Reads an uploaded object in a worker: a large STL takes seconds, in which no other tab may wait.

An `ObjectFile` is a `workbench.live.preview_call`: its answer, the object, is not stored but
becomes part of the press. STEP files go another way (`workbench.edit.indenter_edit.cad_trial`), as
bodies do.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from workbench.core.base.monitor import Monitor
from workbench.core.press.indenter import Indenter
from workbench.edit.indenter_edit import AT, SMALLER_MESH, uploaded
from workbench.pipeline.store import Store
from workbench.system.uploads import MOST_BYTES, check_upload


@dataclass(frozen=True, kw_only=True, slots=True)
class ObjectFile:
    """An uploaded STL or OBJ file; a `PreviewCall`."""

    name: str
    """As the browser sent it."""
    content: bytes

    def __post_init__(self) -> None:
        # Refused here, so that a file that is too large is not sent to the worker first.
        check_upload(self.name, self.content, limit_bytes=MOST_BYTES, hint=SMALLER_MESH, at=AT)

    @property
    def lane(self) -> str:
        """The worker that answers it: the one that neither meshes nor presses."""
        return "look"

    @property
    def stage(self) -> str:
        """What messages call it."""
        return "intake"

    @property
    def needs(self) -> tuple[str, ...]:
        """Nothing has to be stored before."""
        return ()

    def answer(self, store: Store, kept: dict[str, Any], monitor: Monitor) -> Indenter:
        """Read it.

        Raises:
            DesignError: If it is no usable closed mesh.
        """
        return uploaded(self.name, self.content)
