"""Records: figures in a JSON file with the command that made them and the code they rest on.

What takes minutes or hours is measured once and kept. A record names a digest of the code that
made it; once that code is another, the figures are those of a program that is no more: the record
is *stale*, and who reads it is told so with the command that makes it anew. One without a digest is
stale as well: nobody can say what made it.

The digest is of the modules named and of all that they import, lazily too, down to the limits of
the project. It is of their syntax without docstrings, so comments, words and layout do not count,
and it is the same on every version of Python. What is only for type checkers takes no part, nor
what is found by listing a folder (an object, a family): a record names the files it uses of those.
Modules that the figures cannot depend on are named `apart` and not entered.

Code that an installation leaves out (`tests`) cannot have been changed in it: figures from there
count as recorded, and the tests of the repository hold them to their code.

Left out: versions of NumPy, SciPy and of what else is not ours.
"""

from __future__ import annotations

import ast
import datetime
import functools
import hashlib
import json
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from workbench.core.base.digest import KEY_LENGTH, digest
from workbench.core.base.errors import StoreError
from workbench.system.whole_files import write_atomically

ROOT = Path(__file__).parent.parent.parent
"""Folder of the packages."""
OURS = ("workbench", "sim", "geometry", "designs", "ui", "docs", "tests")
PARTS = {"command", "code", "made"}
"""What each record says of itself beside its figures."""
UNSAID = ("type_comment", "type_ignores", "kind", "ctx")
"""Fields of the syntax that change nothing that is computed."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Record:
    """Where figures are kept, and on what they rest."""

    path: Path
    command: str
    """What makes it anew, as typed in the repository."""
    sources: tuple[str, ...]
    """Modules, or packages with all their modules, that the figures rest on, and what these
    import."""
    apart: tuple[str, ...] = ()
    """Modules and packages that are imported from there, on which no figure depends."""
    files: tuple[Path, ...] = ()
    """Data that the figures rest on; other bytes are as good as other code."""

    def figures(self) -> dict[str, Any]:
        """What it holds, its own `PARTS` included, stale or not.

        Raises:
            StoreError: If there is none, or it is damaged.
        """
        try:
            found = json.loads(self.path.read_bytes())
        except FileNotFoundError as error:
            raise self._unusable("there is none") from error
        except (OSError, ValueError) as error:
            raise self._unusable(str(error)) from error
        if not isinstance(found, dict):
            raise self._unusable("it is no table")
        return found

    def stale(self) -> str:
        """Why its figures are not those of this program, with the remedy; "" where they are."""
        try:
            found = self.figures()
        except StoreError as error:
            return f"stale: {error.message}; {error.hint}"
        code, made = found.get("code"), found.get("made") or "without a date"
        if not code:
            why = f"the record of {made} does not say which code made it"
        elif code != self.code():
            other = "by other code or from other data" if self.files else "by other code"
            why = f"the record of {made} was made {other}"
        else:
            return ""
        return f"stale: {why}; make it anew: {self.command}"

    def code(self) -> str:
        """Digest of the code and data that the figures rest on, as they are now."""
        if not any(_file(name, ROOT) for name in self.sources):
            # Not installed, so what made the record is what the repository had.
            return str(self.figures().get("code", ""))
        code = code_digest(self.sources, self.apart)
        return digest([code, *map(_file_digest, self.files)]) if self.files else code

    def head(self) -> dict[str, str]:
        """What a record that is begun now says of itself."""
        today = datetime.datetime.now(datetime.UTC).date().isoformat()
        return {"command": self.command, "code": self.code(), "made": today}

    def make(self, measure: Callable[[], Mapping[str, Any]]) -> None:
        """Measure figures and keep them; the code counts as it was before.

        Args:
            measure: Gives figures by name, such as JSON can hold.

        Raises:
            StoreError: If the file cannot be written.
        """
        head = self.head()
        text = json.dumps({**head, **measure()}, indent=1, allow_nan=False)
        write_atomically(self.path, f"{text}\n".encode())

    def _unusable(self, why: str) -> StoreError:
        return StoreError(
            f"the record {self.path.name} cannot be read: {why}",
            hint=f"make it anew: {self.command}",
            at=str(self.path),
        )


@functools.lru_cache(maxsize=64)
def code_digest(sources: tuple[str, ...], apart: tuple[str, ...] = (), *, root: Path = ROOT) -> str:
    """Digest of modules and of all that they import.

    Args:
        sources: Modules, or packages, which stand for all their modules.
        apart: Modules and packages that are not entered.
        root: Folder of the packages.

    Raises:
        StoreError: If one of `sources` is not there, or a file is not Python.
    """
    hasher = hashlib.sha256()
    for name, path in sorted(_reached(sources, apart, root).items()):
        hasher.update(f"{name}\n{_syntax(path, root)[0]}\n".encode())
    return hasher.hexdigest()[:KEY_LENGTH]


def _file_digest(path: Path) -> str:
    """Of what a file holds; "" where there is none."""
    return hashlib.sha256(path.read_bytes()).hexdigest() if path.exists() else ""


def _reached(sources: tuple[str, ...], apart: tuple[str, ...], root: Path) -> dict[str, Path]:
    """Files by the names of their modules."""
    waiting = []
    for name in sources:
        inside = sorted((root / name.replace(".", "/")).rglob("*.py"))
        waiting += [_name(path, root) for path in inside] or [name]
        if _file(name, root) is None and not inside:
            raise StoreError(f"there is no module {name}", hint="correct the record", at=name)
    found: dict[str, Path] = {}
    while waiting:
        name = waiting.pop()
        path = _file(name, root)
        if path is None or name in found or _within(name, apart):
            continue
        found[name] = path
        waiting += _syntax(path, root)[1]
    return found


def _within(name: str, packages: tuple[str, ...]) -> bool:
    return any(name == package or name.startswith(f"{package}.") for package in packages)


def _name(path: Path, root: Path) -> str:
    parts = path.relative_to(root).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def _file(name: str, root: Path) -> Path | None:
    """The file of a module of ours; None where there is none."""
    if name.partition(".")[0] not in OURS:
        return None
    place = root.joinpath(*name.split("."))
    for path in (place.with_suffix(".py"), place / "__init__.py"):
        if path.exists():
            return path
    return None


@functools.lru_cache(maxsize=2048)
def _syntax(path: Path, root: Path) -> tuple[str, tuple[str, ...]]:
    """Digest of what a file computes, and the modules of ours that it imports."""
    try:
        tree = ast.parse(path.read_bytes())
    except (OSError, SyntaxError, ValueError) as error:
        raise StoreError(f"{path} cannot be read as Python: {error}", at=str(path)) from error
    hasher = hashlib.sha256()
    for part in _said(tree):
        hasher.update(f"{part}\n".encode())
    names = (name for name in _imports(tree, root) if name.partition(".")[0] in OURS)
    return hasher.hexdigest(), tuple(dict.fromkeys(names))


def _said(node: Any) -> Iterator[str]:
    """A syntax tree as lines; texts that stand alone, which are docstrings, are left out."""
    if isinstance(node, list):
        for item in node:
            if not _stands_alone(item) and not _for_checkers(item):
                yield from _said(item)
        yield ")"
    elif isinstance(node, ast.AST):
        yield type(node).__name__
        for name, value in ast.iter_fields(node):
            # Later versions of Python add fields; those that are empty say nothing.
            if name not in UNSAID and value is not None and value != []:
                yield f".{name}"
                yield from _said(value)
    else:
        yield f"{type(node).__name__} {node!r}"


def _stands_alone(node: Any) -> bool:
    return (
        isinstance(node, ast.Expr)
        and isinstance(node.value, ast.Constant)
        and isinstance(node.value.value, str)
    )


def _for_checkers(node: Any) -> bool:
    return isinstance(node, ast.If) and ast.unparse(node.test).endswith("TYPE_CHECKING")


def _imports(node: ast.AST, root: Path) -> Iterator[str]:
    """Names of all modules that a tree imports, inside functions too."""
    for child in ast.iter_child_nodes(node):
        if _for_checkers(child):
            continue
        if isinstance(child, ast.Import):
            yield from (alias.name for alias in child.names)
        elif isinstance(child, ast.ImportFrom) and child.module:
            for alias in child.names:
                inner = f"{child.module}.{alias.name}"
                yield inner if _file(inner, root) else child.module
        else:
            yield from _imports(child, root)
