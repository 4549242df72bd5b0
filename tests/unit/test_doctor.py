"""What `workbench doctor` says of forces: the solver of finite elements, and the networks."""

from __future__ import annotations

from pathlib import Path

import pytest

from sim.fem import linear_solver
from tests.made_weights import tiny_weights, write_tiny
from workbench.cli import diagnosis as doctor
from workbench.pipeline import shipped


def line_of(tmp_path: Path, title: str) -> tuple[str, bool]:
    """The line with a title, and whether all is well."""
    lines, healthy = doctor.report(tmp_path / "project")
    (found,) = (line for line in lines if line.startswith(title))
    return found, healthy


def test_the_solver_of_finite_elements_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """With MKL its name; without, how much slower it is and what to install. Both are well."""
    monkeypatch.setattr(doctor, "solver_device", lambda: "cpu")
    for there, says in ((True, "PARDISO of Intel MKL"), (False, "pip install pypardiso")):
        monkeypatch.setattr(linear_solver, "has_pardiso", lambda there=there: there)
        line, healthy = line_of(tmp_path, "finite elements")
        assert says in line and healthy
        assert ("3 times as slow" in line) is not there
        assert "GPU" not in line
    monkeypatch.setattr(doctor, "solver_device", lambda: "cuda")
    line, healthy = line_of(tmp_path, "finite elements")
    assert "the GPU near the contact, elsewhere SuperLU" in line and healthy


def test_shipped_networks_are_listed_or_their_training(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """None: the command that makes one; one: its name; a damaged one: what is wrong, not well."""
    monkeypatch.setattr(shipped, "FOLDER", tmp_path / "shipped")
    line, healthy = line_of(tmp_path, "network: force")
    assert "workbench train make DATA --preset small --target force --out DIR" in line and healthy
    path = write_tiny(tmp_path / "shipped", tiny_weights())
    line, healthy = line_of(tmp_path, "network: force")
    assert path.name in line and healthy
    assert "--target displacement" in line_of(tmp_path, "network: displacement")[0]
    path.write_bytes(path.read_bytes()[:-9])
    line, healthy = line_of(tmp_path, "network: force")
    assert "damaged or cut short" in line and not healthy
    assert line_of(tmp_path, "learned forces on")[0].split()[-1] in ("cpu", "cuda")
