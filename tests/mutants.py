"""Arithmetic changes drawn at random, one at a time: does any test near the changed file notice?

    python -m tests.mutants --count 60 --seed 1 --out mutants.jsonl

Run it in a clone that nobody works in: files of `sim` and `geometry` are changed and put back. A
change is + to -, * to /, a number doubled, < to <=, another index, or a lost minus sign; numbers of
messages and types are left alone. Near a file are the tests that import it, then those that import
what imports it, and so on. A change that no such test notices is a survivor: it needs a test, or
has to be shown to change nothing; where the time is up, nothing is known of it. Where tests fail,
the one that did is named.
"""

from __future__ import annotations

import argparse
import ast
import importlib
import json
import os
import random
import resource
import signal
import sys
import traceback
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import NoReturn

import pytest

ROOT = Path(__file__).parent.parent
PACKAGES = ("workbench", "designs", "geometry", "sim", "ui")
MUTATED = ("sim", "geometry")
SWAPS = {ast.Add: ("+", "-"), ast.Sub: ("-", "+"), ast.Mult: ("*", "/"), ast.Div: ("/", "*")}
ORDERS = {ast.Lt: ("<", "<="), ast.LtE: ("<=", "<"), ast.Gt: (">", ">="), ast.GtE: (">=", ">")}
UNTOUCHED = (ast.JoinedStr, ast.Raise, ast.Assert)
"""Numbers of a message change nothing that is computed."""
LONG = ("tests/property", "tests/presets", "tests/convergence")
"""Where tests take longest."""
MOST_FILES = 8
"""Test files that are run for a change, the nearest first."""
CHOSEN = "not slow and not ui and not gpu"
SLOW_IMPORTS = (
    "scipy.spatial",
    "torch",
    "taichi",
    "trimesh",
    "cv2",
    "build123d",
    "pyvista",
    "viser",
)
"""Imported once, before any of our modules is."""


@dataclass(frozen=True, kw_only=True)
class Mutant:
    """One change of one line."""

    file: str
    line: int
    first: int
    """Byte of the file at which the change begins."""
    old: str
    new: str
    text: str
    """The line as it was."""


def mutants_of(path: Path) -> Iterator[Mutant]:
    """All changes of a file."""
    source = path.read_bytes()
    starts = [0]
    for line in source.splitlines(keepends=True):
        starts.append(starts[-1] + len(line))

    def place(line: int, column: int) -> int:
        return starts[line - 1] + column

    for node in _arithmetic(ast.parse(source)):
        first = place(node.lineno, node.col_offset)
        last = place(node.end_lineno or 0, node.end_col_offset or 0)
        match node:
            case ast.BinOp(left=left, right=right, op=op):
                pair = SWAPS[type(op)]
            case ast.Compare(left=left, ops=[op], comparators=[right]):
                pair = ORDERS[type(op)]
            case ast.UnaryOp(operand=operand):
                pair, last = ("-", ""), place(operand.lineno, operand.col_offset)
                left = right = None
            case ast.Constant(value=value):
                old = source[first:last].decode()
                pair = (old, "1" if not value else f"{2 * value!r}")
                left = right = None
            case _:
                continue
        if left is not None and right is not None:
            begin = place(left.end_lineno or 0, left.end_col_offset or 0)
            first = source.find(pair[0].encode(), begin, place(right.lineno, right.col_offset))
            if first < 0 or source[first : first + 2] in (b"**", b"//"):
                continue
        number = source.count(b"\n", 0, first)
        text = source.splitlines()[number].decode().strip()
        yield Mutant(
            file=path.relative_to(ROOT).as_posix(),
            line=number + 1,
            first=first,
            old=pair[0],
            new=pair[1],
            text=text,
        )


def _arithmetic(tree: ast.AST) -> Iterator[ast.expr]:
    """Nodes of the kinds that are changed."""
    for name, value in ast.iter_fields(tree):
        if name in ("annotation", "returns", "decorator_list"):
            continue
        for node in value if isinstance(value, list) else [value]:
            if not isinstance(node, ast.AST) or isinstance(node, UNTOUCHED):
                continue
            if _is_changed(node):
                yield node  # type: ignore[misc]
            yield from _arithmetic(node)


def _is_changed(node: ast.AST) -> bool:
    match node:
        case ast.BinOp(op=op):
            return type(op) in SWAPS and not isinstance(node.left, ast.JoinedStr)
        case ast.Compare(ops=[op]):
            return type(op) in ORDERS
        case ast.UnaryOp(op=ast.USub()):
            return True
        case ast.Constant(value=value):
            return isinstance(value, int | float) and not isinstance(value, bool)
    return False


def imports_of(path: Path) -> set[str]:
    """Names of the modules of ours that a file imports, wherever in it."""
    found: set[str] = set()
    for node in ast.walk(ast.parse(path.read_bytes())):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            found |= {node.module} | {f"{node.module}.{alias.name}" for alias in node.names}
    return {name for name in found if name.partition(".")[0] in PACKAGES}


def near_tests(file: str, imports: dict[str, set[str]]) -> list[str]:
    """Test files that reach a module, the nearest first, then those with the fewest imports."""
    near, seen, found = {_module(file)}, set(), []
    stem = Path(file).stem
    while near and len(found) < MOST_FILES:
        tests = [path for path in imports if path.startswith("tests/") and imports[path] & near]
        tests.sort(
            key=lambda path: (stem not in path, path.startswith(LONG), len(imports[path]), path)
        )
        found += [path for path in tests if path not in found and "/test_" in path]
        seen |= near
        others = (path for path in imports if not path.startswith("tests/"))
        near = {_module(path) for path in others if imports[path] & near} - seen
    return found[:MOST_FILES]


def _module(file: str) -> str:
    return file.removesuffix(".py").removesuffix("/__init__").replace("/", ".")


def verdict(tests: list[str], limit_s: int, report: Path) -> str:
    """The test that failed; in words where none did, or none could in the time.

    The tests run in a fork of this process, which has imported what is slow to import and nothing
    of ours.
    """
    child = os.fork()
    if not child:
        _test(tests, limit_s, report)
    _, status = os.waitpid(child, 0)
    code = os.waitstatus_to_exitcode(status)
    lines = report.read_text(encoding="utf-8", errors="replace").splitlines()
    failed = [line for line in lines if line.startswith(("FAILED", "ERROR"))]
    if -code in (signal.SIGXCPU, signal.SIGKILL):
        return f"undecided: {limit_s} s of the processor are up"
    if code < 0:
        return f"FAILED by {signal.Signals(-code).name}"
    if code in (0, 5):
        return "survived"
    return failed[0] if failed else f"ERROR {lines[-3:]}"


def _test(tests: list[str], limit_s: int, report: Path) -> NoReturn:
    code = 70
    try:
        resource.setrlimit(resource.RLIMIT_CPU, (limit_s, limit_s))
        file = os.open(report, os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
        os.dup2(file, 1)
        os.dup2(file, 2)
        code = pytest.main(["-xq", "--no-header", "-p", "no:cacheprovider", "-m", CHOSEN, *tests])
    finally:
        traceback.print_exc()
        sys.stdout.flush()
        os._exit(int(code))


def main() -> None:
    """Draw, run and write one JSON object per change."""
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("--count", type=int, default=60)
    options.add_argument("--seed", type=int, default=1)
    options.add_argument("--files", type=int, default=8, help="test files for each change")
    options.add_argument("--limit-s", type=int, default=120, help="of the processor")
    options.add_argument("--part", default="1/1", help="2/16: the second of sixteen, elsewhere")
    options.add_argument("--out", type=Path, required=True)
    asked = options.parse_args()
    files = [path for top in MUTATED for path in sorted((ROOT / top).rglob("*.py"))]
    every = [mutant for path in files for mutant in mutants_of(path)]
    drawn = random.Random(asked.seed).sample(every, asked.count)
    sources = [path for top in (*PACKAGES, "tests") for path in (ROOT / top).rglob("*.py")]
    imports = {path.relative_to(ROOT).as_posix(): imports_of(path) for path in sources}
    os.environ |= {
        "OMP_NUM_THREADS": "1",
        "PYTHONPATH": str(ROOT),
        "ENABLE_TAICHI_HEADER_PRINT": "0",
    }
    os.chdir(ROOT)
    for module in SLOW_IMPORTS:
        importlib.import_module(module)
    part, parts = map(int, asked.part.split("/"))
    for mutant in drawn[part - 1 :: parts]:
        path, tests = ROOT / mutant.file, near_tests(mutant.file, imports)[: asked.files]
        before = path.read_bytes()
        end = mutant.first + len(mutant.old.encode())
        path.write_bytes(before[: mutant.first] + mutant.new.encode() + before[end:])
        try:
            said = verdict(tests, asked.limit_s, asked.out.with_suffix(".log"))
        finally:
            path.write_bytes(before)
        with asked.out.open("a") as file:
            file.write(json.dumps({**asdict(mutant), "verdict": said, "tests": tests}) + "\n")


if __name__ == "__main__":
    main()
