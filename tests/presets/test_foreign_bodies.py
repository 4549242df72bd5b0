"""Forty bodies of others: read, or refused in one sentence; a few become parts."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from geometry.intake.intake import read_body
from geometry.surface.surface import is_watertight, mesh_volume
from tests.foreign_bodies import FORTY, KINDS, Foreign, written
from workbench.core.base.errors import DesignError
from workbench.core.design.imported import ImportedBody, body_file

pytestmark = pytest.mark.slow

HOPELESS = ("crossing_8.stl", "cad_5.step", "cad_8.step")
"""Two balls apart, a loft that the kernel tessellates in forty layers, and one flat face."""
MADE = ("holes_5.stl", "crossing_2.stl", "cad_4.step")


def test_there_are_forty_of_four_kinds() -> None:
    """Ten each."""
    assert [sum(f.kind == kind for f in FORTY) for kind in KINDS] == [10, 10, 10, 10]


@pytest.mark.parametrize("foreign", FORTY, ids=lambda foreign: foreign.name)
def test_a_foreign_body_is_read_or_refused_in_one_sentence(foreign: Foreign) -> None:
    """Closed and of some volume, with its repair accepted; else named, with a remedy."""
    file = body_file(foreign.name, written(foreign))
    if foreign.name in HOPELESS:
        with pytest.raises(DesignError, match=foreign.name) as caught:
            read_body(ImportedBody(outer=file, repair=True))
        assert "\n" not in caught.value.message
        assert caught.value.hint
        return
    body = read_body(ImportedBody(outer=file, repair=True))
    assert is_watertight(body.outer.faces)
    assert mesh_volume(body.outer.points_mm, body.outer.faces) > 1000.0


@pytest.mark.parametrize("name", MADE)
def test_a_repaired_body_becomes_parts(workbench: Any, tmp_path: Path, name: str) -> None:
    """Refused with the offer; by the flag of that offer exported with its mould."""
    (foreign,) = (f for f in FORTY if f.name == name)
    path = tmp_path / name
    path.write_bytes(written(foreign))
    out = tmp_path / "out"
    refused = workbench("export", path, *foreign.flags, "--out", out)
    assert refused.code == 2, refused.stderr
    assert "run again with --repair: the body is remeshed at" in refused.lines[-1]["hint"]
    # Parts are made of the body itself: the fineness of its mesh is another matter.
    cells = ("--set", "meshing.hex_mm=1.0")
    done = workbench("export", path, *foreign.flags, "--repair", *cells, "--out", out)
    assert done.code == 0, done.stderr
    assert (out / "moulds" / "core.step").is_file()
