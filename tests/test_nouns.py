"""One file per noun: what a light model, an object, a map, a stage, a command is stands in one.

Outside it nothing imports the file or names the record: lists, menus, help and options come from
the package. One default is allowed where a design has to begin with something.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest

from workbench.core.base.records import names, records

ROOT = Path(__file__).parent.parent
TOP = ("workbench", "designs", "geometry", "sim", "ui")
PROOF = ("workbench/proof", "sim/optics/proof", "sim/contact/studies")
"""Where named cases are measured: what they measure must be said."""


@dataclass(frozen=True, kw_only=True)
class Noun:
    """A kind of record."""

    package: str
    record: str
    choice: str = ""
    """Enum whose members are the records, in design files."""
    defaults: tuple[str, ...] = ()
    """The one that is named, and where."""
    readers: tuple[str, ...] = ()
    """Files beside the package that read what one of them makes."""


NOUNS = {
    "light model": Noun(
        package="sim.optics.field.models",
        record="MODEL",
        choice="LightModel",
        defaults=("workbench/core/design/optics.py",),
    ),
    "object": Noun(
        package="workbench.core.objects.kinds",
        record="KIND",
        choice="IndenterKind",
        defaults=("workbench/core/press/indenter.py",),
    ),
    "released object": Noun(package="workbench.core.objects.released", record="KIND"),
    "camera": Noun(package="workbench.core.catalogue.cameras", record="CAMERA"),
    "LED": Noun(package="workbench.core.catalogue.leds", record="LED"),
    "map": Noun(package="sim.optics.maps.kinds", record="MAP"),
    "stage": Noun(
        package="workbench.pipeline.stages",
        record="STAGE",
        # These make calls that no plan has: drawings for lists, the parts of a deck, light alone,
        # presses to fit to.
        readers=(
            "workbench/calibration/stored.py",
            "workbench/report/thumbnails.py",
            "workbench/report/fem_case.py",
            "workbench/live/image_preview.py",
            "workbench/planning/advised.py",
            "workbench/pipeline/fast/condensed.py",
            "workbench/pipeline/fast/hardening.py",
            "ui/panels/simulate/network.py",
        ),
    ),
    "stage of fast contact": Noun(
        package="workbench.pipeline.fast",
        record="STAGE",
        # Tiles of a skin where it is touched.
        readers=(
            "workbench/planning/tile_columns.py",
            "workbench/live/touch_press.py",
        ),
    ),
    "command": Noun(package="workbench.cli.commands", record="COMMAND"),
    "command of a group": Noun(package="workbench.cli.groups", record="COMMAND"),
    "export": Noun(package="workbench.report.exports", record="EXPORT"),
    "family": Noun(package="designs", record="FAMILY"),
    "main sizes of a family": Noun(package="designs.dimensions", record="DIMENSIONS"),
    "task": Noun(package="workbench.tasks.kinds", record="TASK"),
}


def product() -> Iterator[tuple[str, ast.Module]]:
    """Files that run for a designer, by their path."""
    for top in TOP:
        for path in sorted((ROOT / top).rglob("*.py")):
            name = path.relative_to(ROOT).as_posix()
            if not name.startswith(PROOF):
                yield name, ast.parse(path.read_text(encoding="utf-8"))


FILES = dict(product())


def imported(tree: ast.Module) -> Iterator[str]:
    """Every module that a file imports, and every name as if it were one."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module:
            yield node.module
            yield from (f"{node.module}.{alias.name}" for alias in node.names)


def named(tree: ast.Module, choice: str) -> Iterator[str]:
    """Members of an enum that a file names: `Choice.MEMBER` or `Choice("member")`."""
    for node in ast.walk(tree):
        match node:
            case ast.Attribute(value=ast.Name(id=found), attr=member) if found == choice:
                yield member.lower()
            case ast.Call(func=ast.Name(id=found), args=[ast.Constant(value=str(member))]) if (
                found == choice
            ):
                yield member


def literals(tree: ast.Module) -> set[str]:
    """Strings of a file, its docstrings left out."""
    said = {
        id(node.value)
        for node in ast.walk(tree)
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)
    }
    return {
        node.value
        for node in ast.walk(tree)
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in said
    }


def outside(noun: Noun) -> dict[str, ast.Module]:
    folder = noun.package.replace(".", "/") + "/"
    return {name: tree for name, tree in FILES.items() if not name.startswith(folder)}


@pytest.mark.parametrize("noun", NOUNS.values(), ids=list(NOUNS))
def test_nothing_imports_the_file_of_a_record(noun: Noun) -> None:
    """But for the files that are named here."""
    files = {f"{noun.package}.{name}" for name in records(noun.package, noun.record)}
    importers = {name for name, tree in outside(noun).items() if files & set(imported(tree))}
    assert importers == set(noun.readers)


@pytest.mark.parametrize("noun", [noun for noun in NOUNS.values() if noun.choice])
def test_no_member_is_named_but_one_default(noun: Noun) -> None:
    """What belongs to one record is asked of the record."""
    found = {
        name: members
        for name, tree in outside(noun).items()
        if (members := set(named(tree, noun.choice)) & set(names(noun.package)))
    }
    assert set(found) == set(noun.defaults)
    assert all(len(members) == 1 for members in found.values())


@pytest.mark.parametrize("noun", NOUNS.values(), ids=list(NOUNS))
def test_a_name_of_two_words_stands_in_its_file_only(noun: Noun) -> None:
    """Names of one word are words of the language too; those of two can only mean the record."""
    words = {name for name in records(noun.package, noun.record) if "_" in name}
    found = {name: words & literals(tree) for name, tree in outside(noun).items()}
    assert not {name: said for name, said in found.items() if said}


def test_nothing_but_the_layout_imports_a_page() -> None:
    """A tab is found by its folder; the docks of results and view are laid out by the front."""
    importers = {
        name
        for name, tree in FILES.items()
        for module in imported(tree)
        if re.fullmatch(r"ui\.panels\.\w+\.page", module)
        and not name.startswith(module.rpartition(".")[0].replace(".", "/"))
    }
    assert importers == {"ui/app.py"}


def test_what_names_a_record_is_found() -> None:
    """The checks can fail: an import, a member and a literal, each in a line."""
    tree = ast.parse(
        "from sim.optics.field.models import direct\nLightModel.DIRECT\nword = 'plane_target'\n"
    )
    assert "sim.optics.field.models.direct" in set(imported(tree))
    assert set(named(tree, "LightModel")) == {"direct"}
    assert "plane_target" in literals(tree)
