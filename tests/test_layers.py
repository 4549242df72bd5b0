"""The house: packages in ranks that point one way, rooms of a size to look over, no circles."""

from __future__ import annotations

import ast
import functools
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
TOP = ("workbench", "designs", "geometry", "sim", "ui")
RANKS = """
    workbench.core  workbench.core.base
    workbench.core.objects  workbench.core.objects.kinds  workbench.core.objects.released
    workbench.core.design  workbench.core.catalogue  workbench.core.catalogue.cameras
    workbench.core.catalogue.leds  workbench.core.result  workbench.core.press
    workbench.system

    geometry  geometry.formats  geometry.drawing  geometry.surface  geometry.body
    designs  designs.dimensions
    geometry.intake  geometry.objects  geometry.volume  geometry.mould  geometry.housing
    geometry.workshop

    sim  sim.forces.network  sim.forces.training  sim.forces
    sim.contact.grid  sim.contact.objects  sim.contact.motion  sim.contact.region
    sim.contact.engine  sim.contact.readout  sim.contact.particles  sim.contact.solver
    sim.contact.soft  sim.contact  sim.contact.studies
    sim.fem  sim.fem.decks  sim.fem.studies
    sim.optics  sim.optics.camera  sim.optics.light  sim.optics.transport  sim.optics.field
    sim.optics.field.models  sim.optics.raster  sim.optics.studio
    sim.optics.maps  sim.optics.maps.kinds  sim.optics.proof
    sim.condensed  sim.reading  sim.reading.network

    workbench.view  workbench.pipeline  workbench.pipeline.stages  workbench.pipeline.fast
    workbench.planning  workbench.cluster
    workbench.project  workbench.edit  workbench.live  workbench.robots  workbench.sensor
    workbench.simulators
    workbench.report  workbench.report.exports
    workbench.variants  workbench.calibration.seen  workbench.calibration
    workbench.photographs  workbench.reading
    workbench.learning  workbench.learning.dataset  workbench.learning.making
    workbench.learning.training  workbench.learning.readers  workbench.learning.lerobot
    workbench.environments  workbench.taxim  workbench.twin
    workbench.search
    workbench.proof  workbench.proof.validation  workbench.proof.validation.geometry
    workbench.proof.validation.optics  workbench.proof.validation.contact
    workbench.proof.validation.fem  workbench.proof.validation.reading
    workbench.proof.benchmarks
    workbench.learning.evaluation
    workbench.tasks.networks  workbench.tasks.kept  workbench.tasks
    workbench.tasks.kinds
    workbench.proof.validation.learned
    workbench.proof.validation.published
    workbench.proof.validation.tasks  workbench.proof.validation.sensor
    workbench.proof.validation.search

    workbench.door  workbench

    ui.patches  ui.page  ui.scene  ui.desk
    ui.panels  ui.panels.compare  ui.panels.make  ui.panels.mesh  ui.panels.optics  ui.panels.shape
    ui.panels.simulate  ui.panels.view  ui.panels.results  ui.panels.calibrate
    ui.panels.read  ui.panels.search
    ui
    workbench.cli  workbench.cli.groups  workbench.cli.commands
""".split()
"""Packages, the lowest first: a module imports its own package and those before it."""
MOST_MODULES = 25
MOST_LINES = 300
MOST_PARAMETERS = 6
MOST_OF_A_KERNEL = 10
MANY_OF_A_KERNEL = {
    "sim.contact.engine.kernels.substep_of.substep": "in a compute graph, which has no bundles",
    "sim.contact.engine.kernels.tied_substep_of.tied_substep": "the same",
    "sim.contact.soft.kernels._make_substep.soft_substep": "the same",
}
"""Kernels that keep more, and why."""
DOOR = ("workbench.cli.commands.serve", "ui.app")
"""The command line starts the front here, and touches it nowhere else."""


def module_name(path: Path) -> str:
    parts = path.relative_to(ROOT).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


MODULES = {module_name(p): p for name in TOP for p in sorted((ROOT / name).rglob("*.py"))}
"""Files by the names that they are imported by."""


def package_of(module: str) -> str:
    return module if MODULES[module].name == "__init__.py" else module.rpartition(".")[0]


def imports(tree: ast.AST) -> Iterator[str]:
    """Everything imported anywhere in a file: inside functions and for type checkers too."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert not node.level, "imports are absolute"
            for alias in node.names:
                inner = f"{node.module}.{alias.name}"
                yield inner if inner in MODULES else node.module or ""


@functools.cache
def imported(module: str) -> frozenset[str]:
    """Modules of ours that a module imports."""
    found = set(imports(ast.parse(MODULES[module].read_text())))
    return frozenset(name for name in found if name in MODULES) - {module}


def modules_in(package: str) -> list[str]:
    return [module for module in MODULES if package_of(module) == package]


def test_every_package_has_its_rank() -> None:
    """The list names all packages once."""
    assert sorted(RANKS) == sorted({package_of(module) for module in MODULES})


@pytest.mark.parametrize("package", RANKS)
def test_imports_point_one_way(package: str) -> None:
    """No module imports a package of a higher rank, not even lazily or for its types."""
    allowed = set(RANKS[: RANKS.index(package) + 1])
    if package.startswith("workbench.cli"):
        allowed -= {name for name in RANKS if name.split(".")[0] == "ui"}
    wrong = [
        (module, target)
        for module in modules_in(package)
        for target in imported(module)
        if package_of(target) not in allowed and (module, target) != DOOR
    ]
    assert not wrong


@pytest.mark.parametrize("package", RANKS)
def test_a_room_can_be_looked_over(package: str) -> None:
    """A package has at most 25 modules and says what it is for."""
    rooms = modules_in(package)
    assert len(rooms) - 1 <= MOST_MODULES
    assert ast.get_docstring(ast.parse(MODULES[package].read_text()))


def test_no_files_import_each_other() -> None:
    """No circle of files, with lazy imports and those for types."""
    assert circles_of(sorted(MODULES)) == []


def circles_of(modules: list[str]) -> list[set[str]]:
    """Groups of files that reach each other, by what each of them reaches."""
    reached = {module: reach(module) for module in modules}
    circles = []
    for module in modules:
        circle = {other for other in reached[module] if module in reached[other]}
        if circle and circle not in circles:
            circles.append(circle)
    return circles


def reach(module: str) -> set[str]:
    """All that a module imports, and what that imports."""
    found: set[str] = set()
    todo = list(imported(module))
    while todo:
        here = todo.pop()
        if here not in found:
            found.add(here)
            todo += imported(here)
    return found


def test_core_imports_only_the_standard_library_and_numpy() -> None:
    """core has no third-party import but numpy."""
    for module, path in MODULES.items():
        if module.startswith("workbench.core"):
            for name in imports(ast.parse(path.read_text())):
                top = name.split(".")[0]
                assert top in sys.stdlib_module_names or top in ("numpy", "workbench"), module


def test_front_loads_no_heavy_package() -> None:
    """`import ui.app` leaves taichi, torch and build123d out of the process."""
    code = (
        "import sys, ui.app;"
        "print([m for m in ('taichi', 'torch', 'build123d') if m in sys.modules])"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT
    )
    assert done.stdout.strip() == "[]"


def test_no_file_is_longer_than_300_lines() -> None:
    """Of the product: a file over 300 lines has a second idea, which gets a file of its own."""
    for path in MODULES.values():
        assert len(path.read_text().splitlines()) <= MOST_LINES, path


def functions(
    tree: ast.AST, place: str
) -> Iterator[tuple[str, ast.FunctionDef | ast.AsyncFunctionDef]]:
    """All functions below a node, with the dotted names that they are found by."""
    for node in ast.iter_child_nodes(tree):
        here = place
        if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)):
            here = f"{place}.{node.name}"
            if not isinstance(node, ast.ClassDef):
                yield here, node
        yield from functions(node, here)


def parameter_count(function: ast.FunctionDef | ast.AsyncFunctionDef) -> int:
    """Parameters but for the object itself and the monitor."""
    own = function.args
    names = [each.arg for each in (*own.posonlyargs, *own.args, *own.kwonlyargs)]
    return len([name for name in names if name not in ("self", "cls", "monitor")])


def compiled(function: ast.FunctionDef | ast.AsyncFunctionDef) -> bool:
    """Whether Taichi compiles a function."""
    kinds = ("ti.kernel", "ti.func", "ti.real_func")
    return any(ast.unparse(each).split("(")[0] in kinds for each in function.decorator_list)


def with_more_parameters(most: int, *, taichi: bool) -> set[str]:
    """Functions that have more parameters: those that Taichi compiles, or all others."""
    return {
        name
        for module, path in MODULES.items()
        for name, function in functions(ast.parse(path.read_text()), module)
        if compiled(function) is taichi and parameter_count(function) > most
    }


def test_no_function_has_more_than_6_parameters() -> None:
    """What Taichi compiles is counted apart."""
    assert with_more_parameters(MOST_PARAMETERS, taichi=False) == set()


def test_no_kernel_has_more_than_10_parameters() -> None:
    """Taichi's kernels and functions take bundles, but for the named ones."""
    assert with_more_parameters(MOST_OF_A_KERNEL, taichi=True) == MANY_OF_A_KERNEL.keys()
