"""Shipped designs as robots' programs read them: each loads, with the masses of its solids."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from workbench.core.design.design import Meshing, SensorDesign
from workbench.project.named_designs import load_design
from workbench.robots.robot_body import PRINT_g_cm3, RESIN_g_cm3, robot_body
from workbench.robots.robot_files import robot_files


@pytest.mark.slow
@pytest.mark.parametrize("name", ["geltip", "pad", "trunk", "paw"])
def test_a_design_loads_in_mujoco(
    name: str, made: Callable[[SensorDesign, str], Any], tmp_path: Path
) -> None:
    """Elastomer: the CAD kernel's volume times its density; rigid parts: those of the housing."""
    mujoco = pytest.importorskip("mujoco")
    design = dataclasses.replace(load_design(name), meshing=Meshing(hex_mm=0.8))
    solid, housing = made(design, "build"), made(design, "housing")
    body = robot_body(design, solid, housing, made(design, "mesh").outer)
    for file, content in robot_files(body).items():
        (tmp_path / file).write_bytes(content)
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "sensor.xml"))
    soft_kg = solid.volume_mm3 * design.material.density_g_cm3 * 1e-6
    # Triangles of the body lie inside what is round.
    assert model.body("skin").mass[0] == pytest.approx(soft_kg, rel=0.01)
    rigid_kg = sum(
        part.volume_mm3 * (RESIN_g_cm3 if part.name == "support" else PRINT_g_cm3) * 1e-6
        for part in housing.parts
    )
    assert model.body("sensor").mass[0] == pytest.approx(rigid_kg, rel=0.01)
    data = mujoco.MjData(model)
    for _ in range(1000):
        mujoco.mj_step(model, data)
    assert not data.warning.number.any()
