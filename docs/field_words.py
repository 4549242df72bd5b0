"""What the source says of fields and choices: the docstring below each, as one line."""

from __future__ import annotations

import ast
import functools
import importlib
import inspect
import itertools
import re
import sys
from typing import Any

from workbench.core.base.records import names
from workbench.core.design.lighting import LightModel
from workbench.core.objects.kind import PACKAGES
from workbench.core.press.indenter import IndenterKind

FILES: dict[Any, dict[str, str]] = {
    LightModel: {"sim.optics.field.models": ""},
    IndenterKind: PACKAGES,
}
"""Choices that are the files of packages, and what stands before their names."""


@functools.cache
def field_docs(cls: type) -> dict[str, str]:
    """The docstring below each field or choice, as one line; those without one are left out."""
    (body,) = (
        node.body
        for node in ast.walk(_tree(cls.__module__))
        if isinstance(node, ast.ClassDef) and node.name == cls.__name__
    )
    found = {}
    for node, below in itertools.pairwise(body):
        match node, below:
            case (
                ast.AnnAssign(target=ast.Name(id=name)) | ast.Assign(targets=[ast.Name(id=name)]),
                ast.Expr(value=ast.Constant(value=str(text))),
            ):
                found[name] = one_line(text)
    return found


@functools.cache
def _tree(module: str) -> ast.Module:
    return ast.parse(inspect.getsource(sys.modules[module]))


def one_line(text: str) -> str:
    """A docstring as one line that may stand in a cell of a table."""
    return re.sub(r"\s+", " ", text).strip().replace("|", "\\|")


def of_files(packages: dict[str, str]) -> dict[str, str]:
    """What each file of packages says in its first sentence, by its choice in capitals."""
    found = {}
    for package, before in packages.items():
        for name in names(package):
            doc = importlib.import_module(f"{package}.{name}").__doc__ or ""
            found[f"{before}{name}".upper()] = one_line(doc.partition("\n\n")[0])
    return found


def choices(kind: Any) -> str:
    """The choices of an enum, each with what it means where that is said."""
    words = of_files(FILES[kind]) if kind in FILES else field_docs(kind)
    shown = []
    for member in kind:
        text = words.get(member.name, "")
        shown.append(f"`{member.value}`" + (f": {text.rstrip('.')}" if text else ""))
    return "; ".join(shown)
