"""Saved variants: a design with its press, tags, a note, its figures and the keys of its results.

One TOML file each, `variants/NAME.toml`, and beside it `NAME.png`, its thumbnail. The name is that
of the file. `variant_files` lists, renames and deletes them.
"""

from __future__ import annotations

import contextlib
import dataclasses
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from workbench.core.base.errors import DesignError, shown
from workbench.core.base.version import VERSION
from workbench.pipeline.store import Store
from workbench.planning.plan import plan
from workbench.project.design_toml import design_to_toml
from workbench.project.project import Project
from workbench.project.state import State, case_table, read_state
from workbench.system.whole_files import kept_text, toml_table, write_atomically
from workbench.variants.score_card import figures, finite_figures

FOLDER = "variants"
KEPT = ("build", "mesh", "press", "shoot", "maps", "mould", "housing", "recipe")
"""Stages whose keys a variant keeps."""
LONGEST_NOTE = 2000


@dataclass(frozen=True, kw_only=True, slots=True)
class Variant:
    """A design and its press as they were when they were kept."""

    name: str
    state: State
    keys: Mapping[str, str]
    """Keys of the results by stage, as they were when it was kept."""
    metrics: Mapping[str, float]
    """Finite figures of the score card."""
    tags: tuple[str, ...] = ()
    note: str = ""
    saved: str = ""
    """When it was kept: date and time of day; "" of a file from before that was noted."""
    version: str = ""
    """Version of the workbench that kept it."""


def folder(project: Project) -> Path:
    """Where the variants of a project lie."""
    return project.folder / FOLDER


def variant_path(project: Project, name: str) -> Path:
    """File of a variant.

    Raises:
        DesignError: If the name cannot be one.
    """
    with contextlib.suppress(DesignError):
        return folder(project) / project.design_path(name).name
    # The design's own name is another field: the message must not land there.
    raise DesignError(
        f"{shown(name)} cannot be what a variant is called",
        hint="use letters, digits, spaces and dashes, at most 80",
        at="variant",
    )


def save_variant(
    project: Project,
    name: str,
    state: State,
    *,
    tags: Sequence[str] = (),
    note: str = "",
    replace: bool = False,
) -> Variant:
    """Keep a design and its press with the figures of all that is stored of them.

    Args:
        project: Where to.
        name: Of the variant.
        state: Design and press.
        tags: Words to find it by.
        note: Free text.
        replace: Whether a variant of that name may be overwritten.

    Raises:
        DesignError: If the name cannot be one or is taken, or the note is too long.
        StoreError: If a result is damaged or the folder cannot be written.
    """
    path = variant_path(project, name)
    if not replace:
        refuse_taken(path)
    if len(note) > LONGEST_NOTE:
        raise DesignError(
            f"the note has {len(note)} characters, the limit is {LONGEST_NOTE}",
            hint="shorten it",
            at="note",
        )
    keys = stored_keys(project.store, {}, planned_keys(state))
    variant = Variant(
        name=name,
        state=State(design=dataclasses.replace(state.design, name=name), case=state.case),
        keys=keys,
        metrics=figures(project.store, state, keys),
        tags=read_tags(",".join(tags)),
        note=note,
        saved=time.strftime("%Y-%m-%d %H:%M"),
        version=VERSION,
    )
    write_variant(project, variant)
    return variant


def write_variant(project: Project, variant: Variant) -> None:
    """Write the file of a variant, in place of one of that name.

    Raises:
        StoreError: If the folder cannot be written.
    """
    path = variant_path(project, variant.name)
    names = ("name", "tags", "note", "saved", "version", "keys", "metrics")
    table = {name: getattr(variant, name) for name in names}
    project.keep_files(variant.state.design)
    press = case_table(variant.state.case, project)
    text = design_to_toml(variant.state.design, press_case=press, variant=table)
    write_atomically(path, text.encode())


def load_variant(project: Project, name: str) -> Variant:
    """Read a kept variant.

    Raises:
        DesignError: If the file is gone or was edited into nonsense.
    """
    path = variant_path(project, name)
    try:
        text = kept_text(path)
        table: dict[str, Any] = toml_table(text)["variant"]
        fields = _fields(table)
    except (OSError, ValueError, KeyError, AttributeError, TypeError) as error:
        what = f"it has no {error}" if isinstance(error, KeyError) else str(error)
        raise DesignError(
            f"variant {shown(name)} cannot be read: {what}", hint=f"see {path}", at="variant"
        ) from error
    state = read_state(text, project, source=str(path))
    named = State(design=dataclasses.replace(state.design, name=name), case=state.case)
    return Variant(name=name, state=named, **fields)


def _fields(table: Mapping[str, Any]) -> dict[str, Any]:
    """The table of a variant; files of the first version have a `shoot_key` alone.

    Raises:
        ValueError: If a figure is not a number.
        KeyError: If there are no figures or no keys.
    """
    keys = table["keys"] if "keys" in table else {"shoot": table["shoot_key"]}
    return {
        "keys": {str(stage): _key(key) for stage, key in keys.items()},
        "metrics": finite_figures({str(k): float(v) for k, v in table["metrics"].items()}),
        "tags": read_tags(",".join(str(tag) for tag in table.get("tags", ()))),
        "note": str(table.get("note", ""))[:LONGEST_NOTE],
        "saved": str(table.get("saved", "")),
        "version": str(table.get("version", "")),
    }


def _key(key: Any) -> str:
    # A key becomes part of a path in the store.
    if not str(key).isalnum():
        raise ValueError(f"{shown(key)} is not the key of a result")
    return str(key)


def read_tags(text: str) -> tuple[str, ...]:
    """Words between commas, each once, in their order."""
    return tuple(dict.fromkeys(word.strip()[:40] for word in text.split(",") if word.strip()))


def result_keys(project: Project, variant: Variant) -> dict[str, str]:
    """Keys of the variant's results that are still stored, by stage.

    Raises:
        DesignError: If the design is refused.
    """
    return stored_keys(project.store, variant.keys, planned_keys(variant.state))


def planned_keys(state: State) -> dict[str, str]:
    """Keys that the results of a design and its press have, by stage; milliseconds of digests.

    Raises:
        DesignError: If the design is refused.
    """
    calls = plan(state.design, state.case)
    return {stage: calls[stage].key for stage in KEPT if stage in calls}


def stored_keys(
    store: Store, kept: Mapping[str, str], planned: Mapping[str, str]
) -> dict[str, str]:
    """Those of a variant's keys that are still stored, by stage.

    Of a stage that a newer version computed again the kept result goes first: the figures are its.
    """
    both = (*planned.items(), *kept.items())
    return {stage: key for stage, key in both if store.has(stage, key)}


def refuse_taken(path: Path) -> None:
    if path.exists():
        raise DesignError(
            f"there is a variant {shown(path.stem)} already",
            hint="choose another name, or rename the other one first",
            at="variant",
        )
