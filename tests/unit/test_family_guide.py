"""The family of docs/new-family.md: copied out of the guide and used as it stands."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import pytest

import designs
from designs import family as registry
from geometry.surface.surface import is_watertight, mesh_volume
from workbench.core.base.monitor import silent
from workbench.core.base.records import records
from workbench.core.design.design import Layers
from workbench.pipeline.stages.build import BuildInputs, build

GUIDE = Path(__file__).parents[2] / "docs" / "new-family.md"


@pytest.fixture
def block(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[str]:
    """The guide's code as a module that the registry finds; forgotten afterwards."""
    (code,) = re.findall(r"^```python\n(.*?)^```$", GUIDE.read_text(), re.MULTILINE | re.DOTALL)
    (tmp_path / "block.py").write_text(code)
    monkeypatch.setattr(designs, "__path__", [*designs.__path__, str(tmp_path)])
    records.cache_clear()
    yield "block"
    records.cache_clear()


def test_the_guides_family_needs_nothing_but_its_file(block: str) -> None:
    """V = 24^2 30 - 20^2 28 = 6080 mm3, watertight, with sliders and no notice."""
    shape = registry.resolve_shape(block, {})
    solid = build(
        BuildInputs(family=block, shape=shape, layers=Layers(elastomer_mm=2.0)), monitor=silent
    )
    assert is_watertight(solid.membrane.faces)
    # Planes only: the kernel and the triangles are exact.
    assert solid.volume_mm3 == pytest.approx(6080.0, rel=1e-9)
    volume = mesh_volume(solid.membrane.points_mm, solid.membrane.faces)
    assert volume == pytest.approx(6080.0, rel=1e-9)
    assert solid.notice == ""
    assert [slider.name for slider in registry.sliders(block)][:2] == ["side_mm", "height_mm"]


def test_the_guides_family_has_a_fallback(block: str) -> None:
    """The same 6080 mm3 by signed distance; its edges are rounded by about 0.4 mm."""
    from geometry.body.implicit import solid_from_fields

    fields = registry.family(block).fields(registry.resolve_shape(block, {}), Layers())
    solid = solid_from_fields(fields, wall_mm=2.0, support_mm=1.0)
    # 190 mm of edges that lose a corner of about 0.4 x 0.4 / 2 mm2 each: 0.25 %.
    assert solid.volume_mm3 == pytest.approx(6080.0, rel=5e-3)
