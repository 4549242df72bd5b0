"""A side of a comparison: a kept variant, or the design as it stands, with what is stored of it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from workbench.core.result.sensing import Shot
from workbench.pipeline.stage import Call
from workbench.pipeline.store import Store
from workbench.project.project import Project
from workbench.project.state import State
from workbench.variants.score_card import Figures, figures
from workbench.variants.variants import KEPT, Variant, result_keys

NOW = "* the design as it stands"
"""Its entry in the lists: no variant can have this name."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Side:
    """One of the two that are compared."""

    name: str
    state: State
    keys: Mapping[str, str]
    """Keys of the results that are stored, by stage."""
    figures: Figures
    note: str = ""
    saved: str = ""

    def load(self, store: Store, stage: str) -> Any:
        """A stored result, or None.

        Raises:
            StoreError: If it is damaged.
        """
        key = self.keys.get(stage)
        return store.load(stage, key) if key is not None and store.has(stage, key) else None

    def shot(self, store: Store) -> Shot | None:
        """The images of its press, or None.

        Raises:
            StoreError: If they are damaged.
        """
        return self.load(store, "shoot")


def side_of_variant(project: Project, variant: Variant) -> Side:
    """A kept variant; its figures are those that were kept."""
    return Side(
        name=variant.name,
        state=variant.state,
        keys=result_keys(project, variant),
        figures=variant.metrics,
        note=variant.note,
        saved=variant.saved,
    )


def side_as_it_stands(store: Store, state: State, calls: Mapping[str, Call]) -> Side:
    """The design as it stands, with the figures of what is stored of it.

    Raises:
        StoreError: If a result is damaged.
    """
    keys = {s: calls[s].key for s in KEPT if s in calls and store.has(s, calls[s].key)}
    return Side(name=NOW, state=state, keys=keys, figures=figures(store, state, keys))
