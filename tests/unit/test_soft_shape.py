"""The shape of a soft object, and its softness in a project and on the command line."""

import dataclasses
from pathlib import Path

import numpy as np

from workbench.cli.command_line import parser
from workbench.cli.press_options import _indenter
from workbench.core.press.indenter import Indenter
from workbench.core.press.soft_body import SoftBody
from workbench.core.result.sensing import Contact
from workbench.edit.indenter_choice import choose_indenter
from workbench.project.kept_indenters import indenter_table, read_indenter
from workbench.project.project import Project
from workbench.view.soft_shape import deformed_mm, is_soft


def contact(**fields: object) -> Contact:
    names = {f.name for f in dataclasses.fields(Contact) if f.default is dataclasses.MISSING}
    needed = {
        f.name: np.zeros((1, 3))
        for f in dataclasses.fields(Contact)
        if f.name in names and f.default_factory is dataclasses.MISSING
    }
    return Contact(**{**needed, **fields})  # type: ignore[arg-type]


def test_vertices_follow_a_linear_field_exactly_and_the_nearest_node_beyond() -> None:
    """u = (0.1 x, 0.2 y, 0.3 z) on a lattice of 0.5 mm; at (9, 0, 0) that of the end node."""
    axis = -1.0 + 0.5 * np.arange(5)
    x, y, z = np.meshgrid(axis, axis, axis, indexing="ij")
    field = np.stack([0.1 * x, 0.2 * y, 0.3 * z], axis=-1)[None].astype(np.float32)
    press = contact(object_mm=field, object_origin_mm=np.full(3, -1.0), object_spacing_mm=0.5)
    assert is_soft(press)
    assert not is_soft(contact())
    points = np.array([[0.3, -0.7, 0.1], [1.0, 1.0, -1.0], [9.0, 0.0, 0.0]])
    exact = points * [1.1, 1.2, 1.3]
    exact[2] = [9.1, 0.0, 0.0]
    np.testing.assert_allclose(deformed_mm(press, 0, points), exact, atol=1e-6)


def test_softness_of_a_primitive_and_of_a_mesh_survives_a_restart(tmp_path: Path) -> None:
    """Written into a project and read again: the same modulus."""
    project, soft = Project(tmp_path), SoftBody(young_MPa=0.3, held_share=0.4)
    for indenter in (Indenter(), choose_indenter("banana")):
        kept = dataclasses.replace(indenter, soft=soft)
        assert read_indenter(indenter_table(kept, project), project).soft == soft


def test_command_line_makes_an_object_soft() -> None:
    """`--soft-mpa 0.2` is its modulus; without it the object is rigid."""
    words = ["run", "geltip", "--out", "x"]
    assert _indenter(parser().parse_args([*words, "--soft-mpa", "0.2"])).soft == SoftBody(
        young_MPa=0.2
    )
    assert _indenter(parser().parse_args(words)).soft is None
