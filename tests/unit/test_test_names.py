"""Tests that run rarely call names that still exist: a moved function fails here, in seconds."""

from __future__ import annotations

import ast
import importlib
import sys
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path
from types import ModuleType

import pytest

TESTS = Path(__file__).parents[1]
OURS = ("workbench", "designs", "geometry", "sim", "ui", "tests")


def bound_modules(tree: ast.Module) -> dict[str, str]:
    """Name in the file -> dotted module of ours that it is bound to by an import."""
    found: dict[str, str] = {}
    for node in ast.walk(tree):
        if not isinstance(node, ast.ImportFrom) or not node.module:
            continue
        if node.module.split(".")[0] not in OURS:
            continue
        for alias in node.names:
            dotted = f"{node.module}.{alias.name}"
            if alias.name != "*" and is_module(dotted):
                found[alias.asname or alias.name] = dotted
    return found


def is_module(dotted: str) -> bool:
    """Whether the dotted name is a file or folder, asked without running it."""
    if dotted in sys.modules:
        return isinstance(sys.modules[dotted], ModuleType)
    try:
        return find_spec(dotted) is not None
    except ModuleNotFoundError:
        return False


def stale_names(text: str) -> Iterator[str]:
    """`module.name` that a test reads although the module has no such name."""
    tree = ast.parse(text)
    modules = bound_modules(tree)
    assigned = {
        node.id
        for node in ast.walk(tree)
        if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store)
    } | {node.arg for node in ast.walk(tree) if isinstance(node, ast.arg)}
    for node in ast.walk(tree):
        if not isinstance(node, ast.Attribute) or not isinstance(node.value, ast.Name):
            continue
        name = node.value.id
        if name in assigned or name not in modules:
            continue
        if not hasattr(importlib.import_module(modules[name]), node.attr):
            yield f"{modules[name]}.{node.attr}"


@pytest.mark.parametrize(
    "path", sorted(TESTS.rglob("*.py")), ids=lambda path: str(path.relative_to(TESTS))
)
def test_a_test_calls_only_names_that_exist(path: Path) -> None:
    assert not sorted(set(stale_names(path.read_text())))


def test_a_name_that_is_gone_is_found() -> None:
    text = "from sim.optics.proof import transport_checks as checks\nchecks.gone(1)\n"
    assert list(stale_names(text)) == ["sim.optics.proof.transport_checks.gone"]
