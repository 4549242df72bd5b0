"""Fields of a design as typed with `--set`: read by their types, refused with the nearest name."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from workbench.cli.command_line import main
from workbench.core.base.errors import DesignError
from workbench.core.design.design import Law, SensorDesign
from workbench.core.design.lighting import Lamp, LampKind, LightModel
from workbench.edit.item_fields import read_field
from workbench.edit.typed_fields import sets, with_typed
from workbench.project.named_designs import load_design, presets

FINGER = SensorDesign(name="finger")


@pytest.mark.parametrize(
    ("typed", "path", "value"),
    [
        ("material.friction=0.5", "material.friction", 0.5),
        ("design.material.friction = 1", "material.friction", 1.0),
        ("material.law=linear", "material.law", Law.LINEAR),
        ('material.law="linear"', "material.law", Law.LINEAR),
        ("optics.ring.count=6", "optics.ring.count", 6),
        ("optics.ring.colours=#ff0000,#0000ff", "optics.ring.colours", ("#ff0000", "#0000ff")),
        ('optics.ring.colours=["525nm", "5600K"]', "optics.ring.colours", ("525nm", "5600K")),
        ("optics.ring.colours=#00ff00", "optics.ring.colours", ("#00ff00",)),
        ("optics.camera.position_mm=0,1,12", "optics.camera.position_mm", (0.0, 1.0, 12.0)),
        ("optics.camera.position_mm[3]=9", "optics.camera.position_mm[3]", 9.0),
        ("optics.camera.sensor.noise=yes", "optics.camera.sensor.noise", True),
        ("optics.markers.visible=true", "optics.markers.visible", True),
        ("optics.light_model=direct", "optics.light_model", LightModel.DIRECT),
        ("mould.shrink_percent=0.4", "mould.shrink_percent", 0.4),
        ("shape.outer_radius_mm=12", "shape.outer_radius_mm", 12),
        ("casting.silicone=ecoflex_00_30", "casting.silicone", None),
        ("name=a b = c", "name", "a b = c"),
    ],
)
def test_a_field_is_read_by_its_type(typed: str, path: str, value: Any) -> None:
    """Numbers, texts without quotes, lists without brackets, members of enumerations."""
    if value is None:
        from geometry.body.silicones import SILICONES

        value = sorted(SILICONES)[-1]
        typed = f"{path}={value}"
    assert read_field(with_typed(FINGER, [typed]), path) == value


def test_nothing_typed_is_the_design_itself() -> None:
    """And what is typed changes nothing else: each preset comes back the same."""
    assert with_typed(FINGER, []) is FINGER
    for name in presets():
        design = load_design(name)
        assert with_typed(design, [f"material.friction={design.material.friction!r}"]) == design


def test_fields_that_need_each_other_come_in_any_order() -> None:
    """A dot may not be wider than the spacing: 4 mm dots 5 mm apart are set in either order."""
    words = ["optics.markers.diameter_mm=4", "optics.markers.spacing_mm=5"]
    for typed in (words, words[::-1]):
        markers = with_typed(FINGER, typed).optics.markers
        assert (markers.diameter_mm, markers.spacing_mm) == (4.0, 5.0)
    with pytest.raises(DesignError, match="diameter"):
        with_typed(FINGER, words[:1])


def test_items_of_lists_are_named_by_their_number() -> None:
    """A lamp's power; a lamp that is not there is refused, and a whole list sets lamps."""
    lit = FINGER.replace("optics.lamps", (Lamp(), Lamp()))
    found = with_typed(lit, ["optics.lamps[2].power=3", "optics.lamps[1].kind=area"])
    assert [lamp.power for lamp in found.optics.lamps] == [1.0, 3.0]
    assert found.optics.lamps[0].kind is LampKind.AREA
    with pytest.raises(DesignError, match="0 items"):
        with_typed(FINGER, ["optics.lamps[1].power=3"])
    whole = with_typed(FINGER, ['optics.lamps=[{kind="line", power=2}]'])
    assert whole.optics.lamps == (Lamp(kind=LampKind.LINE, power=2.0),)
    seen = with_typed(FINGER, ["optics.cameras=[{fov_x_deg=90}]"])
    assert with_typed(seen, ["optics.cameras[1].fov_x_deg=80"]).optics.cameras[0].fov_x_deg == 80.0


def test_factors_follow_the_number_of_leds() -> None:
    """Nine LEDs with factors, then six: the first six keep theirs."""
    powers = (0.5, *(1.0,) * 8)
    ring = with_typed(FINGER.replace("optics.ring.powers", powers), ["optics.ring.count=6"])
    assert ring.optics.ring.powers == (0.5, *(1.0,) * 5)


def test_constants_of_the_elastomer_stand_for_its_moduli() -> None:
    """As in a design file: both together, in place of E and nu."""
    typed = ["material.c10_MPa=0.025", "material.d1_per_MPa=4.1379"]
    material = with_typed(FINGER, typed).material
    assert material.young_MPa == pytest.approx(0.145, rel=0.01)
    with pytest.raises(DesignError, match="d1_per_MPa"):
        with_typed(FINGER, typed[:1])


def test_a_picture_is_named_by_its_file(tmp_path: Path) -> None:
    """A file that is not there is refused by name; nothing typed takes the picture away."""
    with pytest.raises(DesignError, match=r"idle\.png"):
        with_typed(FINGER, [f"optics.background={tmp_path / 'idle.png'}"])
    from workbench.project.photos import shipped_photos

    name, picture = next(iter(shipped_photos().items()))
    camera = FINGER.optics.camera
    typed = [f"optics.markers.picture=builtin:{name}", "optics.camera.width_px=320"]
    found = with_typed(FINGER, typed)
    assert found.optics.markers.picture == picture
    assert found.optics.camera.height_px == camera.height_px
    assert with_typed(found, ["material.friction=0.2"]).optics.markers.picture == picture
    assert with_typed(found, ["optics.markers.picture="]).optics.markers.picture is None


@pytest.mark.parametrize(
    ("typed", "nearest"),
    [
        ("material.fricton=0.5", "material.friction"),
        ("friction=0.5", "material.friction"),
        ("optics.rng.radius_mm=5", "optics.ring.radius_mm"),
        ("shape.outer_radius=5", "shape.outer_radius_mm"),
        ("optics.lamps.power=5", "optics.lamps[1].power"),
        ("youngs_MPa=0.2", "material.young_MPa"),
        ("body.outer=x.stl", ""),
        ("case.press.depth_mm=1", "options of its own"),
        ("optics.ring[1].count=3", ""),
        ("..=3", ""),
    ],
)
def test_a_misspelt_field_is_refused_with_the_nearest(typed: str, nearest: str) -> None:
    """The hint has a path that can be typed."""
    with pytest.raises(DesignError) as caught:
        with_typed(FINGER, [typed])
    assert nearest in caught.value.hint
    assert caught.value.hint


@pytest.mark.parametrize(
    ("typed", "at"),
    [
        ("material.friction=much", "material.friction"),
        ("material.friction=9", "material.friction"),
        ("material.friction=", "material.friction"),
        ("material.law=rubber", "material.law"),
        ("optics.ring.count=2.5", "optics.ring.count"),
        ("optics.ring.count=true", "optics.ring.count"),
        ("optics.ring.count=-4", "optics.ring.count"),
        ("optics.camera.position_mm=0,1", "optics.camera.position_mm"),
        ("optics.camera.position_mm=a,b,c", "optics.camera.position_mm"),
        ("optics.ring=5", "optics.ring"),
        ("shape.outer_radius_mm=900", "shape.outer_radius_mm"),
        ("shape.outer_radius_mm=wide", "shape.outer_radius_mm"),
        ("optics.markers.visible=maybe", "optics.markers.visible"),
        ("friction", "--set"),
        ("=3", "--set"),
    ],
)
def test_a_value_that_is_refused_names_its_field(typed: str, at: str) -> None:
    """As in a design file."""
    with pytest.raises(DesignError) as caught:
        with_typed(FINGER, [typed])
    assert caught.value.at == at
    assert caught.value.hint


def test_which_fields_were_typed_is_known() -> None:
    """A ring that was chosen is not made to fit."""
    assert sets(["design.optics.ring.radius_mm=5"], "optics.ring")
    assert not sets(["optics.camera.fov_x_deg=5"], "optics.ring")


COMMANDS = (
    "run geltip",
    "export geltip",
    "sweep geltip --field case.press.depth_mm --from 0.5 --to 1",
    "fem solve geltip",
    "fem export geltip",
    "dataset make tiny",
)


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_with_a_design_takes_fields(
    command: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Read before anything is built or written: a misspelt one is bad input, with its remedy."""
    out = tmp_path / "out.inp"
    words = [*command.split(), "--set", "name=other", "--set", "material.fricton=0.5"]
    code = main([*words, "--out", str(out), "--project", str(tmp_path / "project")])
    assert code == 2
    assert "did you mean 'material.friction'?" in capsys.readouterr().err
    assert not out.exists()
