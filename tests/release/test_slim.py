"""With NumPy, SciPy and PyTorch alone: results are read, and the network that ships predicts."""

from __future__ import annotations

import importlib.metadata
import json
import os
import re
import subprocess
from collections.abc import Iterable, Iterator
from pathlib import Path

import numpy as np
import pytest

from tests.release.conftest import ROOT, clean_environment, install, new_environment, ran

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(os.name == "nt", reason="packages are lent by links"),
]
PRODUCED = """
import json, sys
from types import SimpleNamespace
import numpy as np
import workbench as wb

press = np.load("press/contact.npz")
skin = SimpleNamespace(points_mm=press["surface_points_mm"], faces=press["surface_faces"])
network = wb.ForceNetwork(on=skin)
force_N = network.force_N(press["displacement_mm"], press["contact_force_N"])

design = wb.load("finger").replace("optics.light_model", "direct")
design = design.replace("optics.camera.width_px", 80).replace("optics.camera.height_px", 60)
case = wb.Press(depth_mm=0.5, frames=1), wb.ContactSettings(grid_mm=0.8)
ball = wb.Indenter("sphere", size_mm=6.0)
results = wb.evaluate(design, ball, case[0], settings=case[1], project=".workbench")
told = {
    "points": len(network.points_mm),
    "exported_N": (-force_N[-1].sum(axis=0)).tolist(),
    "learned_N": results.forces("learned").reaction_N[-1].tolist(),
    "reaction_N": results.contact.reaction_N[-1].tolist(),
    "images": results.images.shape,
    "heavy": sorted({"taichi", "viser", "cv2", "OCP", "trimesh"} & set(sys.modules)),
}
try:
    wb.evaluate(design.replace("layers.elastomer_mm", 1.5), project=".workbench")
except wb.PackageError as error:
    told |= {"package": error.package, "hint": error.hint}
print(json.dumps(told))
"""


def closure(names: Iterable[str]) -> Iterator[importlib.metadata.Distribution]:
    """Distributions by name and what they need here, each once."""
    from packaging.requirements import Requirement

    waiting, seen = list(names), set()
    while waiting:
        wanted = Requirement(waiting.pop())
        if wanted.name in seen or (wanted.marker and not wanted.marker.evaluate({"extra": ""})):
            continue
        seen.add(wanted.name)
        found = importlib.metadata.distribution(wanted.name)
        yield found
        waiting += found.requires or []


def slim_requirements() -> list[str]:
    """The lines of requirements-slim.txt."""
    lines = (ROOT / "requirements-slim.txt").read_text(encoding="utf-8").splitlines()
    return [line for line in lines if line and not line.startswith("#")]


@pytest.fixture(scope="session")
def slim(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder of the programs of an environment of requirements-slim.txt and the wheel."""
    home = tmp_path_factory.mktemp("slim")
    programs, packages = new_environment(home)
    for one in closure(slim_requirements()):
        tops = {Path(str(file)).parts[0] for file in one.files or []} - {"..", "__pycache__"}
        for top in tops:
            link = packages / top
            if not link.exists():
                link.symlink_to(Path(str(one.locate_file(top))))
    install(wheel, programs, home)
    return programs


def test_slim_requirements_agree_with_those_of_the_whole() -> None:
    """The same versions as in pyproject.toml, which says what they are tested with."""
    whole = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    found = slim_requirements()
    assert {re.split("[=><]", line)[0] for line in found} == {"numpy", "scipy", "torch"}
    for line in found:
        assert f'"{line}"' in whole


def test_other_packages_are_not_there(slim: Path, tmp_path: Path) -> None:
    """What the environment lends is what requirements-slim.txt says, or the rest tests nothing."""
    for module in ("taichi", "viser", "cv2", "build123d", "trimesh", "embreex", "pyvista", "PIL"):
        code = f"import importlib.util as u; print(u.find_spec('{module}'))"
        assert ran([slim / "python", "-c", code], tmp_path).strip() == "None"


def test_results_are_read_and_forces_predicted(slim: Path, pressed: Path) -> None:
    """From an exported and from a stored press the same force, near that of the contact solver."""
    told = json.loads(ran([slim / "python", "-c", PRODUCED], pressed))
    summary = json.loads((pressed / "press" / "summary.json").read_text(encoding="utf-8"))
    assert np.linalg.norm(told["reaction_N"]) == pytest.approx(
        summary["contact"]["normal_N"], rel=1e-2
    )
    assert told["images"] == [2, 60, 80, 3]
    np.testing.assert_allclose(told["exported_N"], told["learned_N"], atol=1e-3)
    # At 0.5 mm the shipped network is known to correct totals by a tenth, not by a half.
    np.testing.assert_allclose(told["learned_N"], told["reaction_N"], atol=0.05)
    assert told["heavy"] == []
    assert told["package"] == "build123d"
    assert "pip install build123d" in told["hint"]


def test_the_command_says_which_package_it_lacks(slim: Path, tmp_path: Path) -> None:
    """In words, with the package's name for pip, and no traceback."""
    assert ran([slim / "workbench", "--version"], tmp_path)
    command = [str(slim / "workbench"), "serve", "--port", "8791"]
    done = subprocess.run(
        command, cwd=tmp_path, env=clean_environment(), capture_output=True, text=True, check=False
    )
    assert done.returncode == 2
    assert "needs the Python package viser" in done.stderr
    assert "pip install viser" in done.stderr and "Traceback" not in done.stderr
