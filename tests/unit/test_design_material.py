"""Materials of design files: constants or moduli, inclusions and the law, there and back."""

from __future__ import annotations

from pathlib import Path

import pytest

from workbench.core.base.errors import DesignError
from workbench.core.design.design import Elastomer, Law, SensorDesign
from workbench.core.design.inclusion import Inclusion, Where
from workbench.pipeline.store import Store
from workbench.project.design_toml import design_from_toml, design_to_toml

HEAD = 'schema = 1\nname = "soft"\nfamily = "finger"\n[material]\n'


def test_a_design_with_two_inclusions_survives_a_file_and_the_store(tmp_path: Path) -> None:
    """from(to(design)) == design: a coat, a ball, the linear law."""
    inclusions = (
        Inclusion(where=Where.COAT, depth_mm=0.4, young_MPa=0.8),
        Inclusion(where=Where.BALL, centre_mm=(0.0, 10.0, 35.0), radius_mm=2.0, poisson=0.3),
    )
    material = Elastomer(inclusions=inclusions, law=Law.LINEAR)
    design = SensorDesign(name="soft", material=material)
    assert design_from_toml(design_to_toml(design)) == design
    store = Store(tmp_path)
    store.save("s", "k", design, seconds=0.0, version=1)
    assert store.load("s", "k") == design


def test_a_file_may_state_neo_hookean_constants() -> None:
    """E = 0.145 MPa, nu = 0.45: mu = 0.05, K = 0.4833; C10 = 0.025, D1 = 4.137931 1/MPa."""
    text = HEAD + "c10_MPa = 0.025\nd1_per_MPa = 4.137931034482759\nfriction = 0.4\n"
    material = design_from_toml(text).material
    assert material.young_MPa == pytest.approx(0.145, rel=1e-12)
    assert material.poisson == pytest.approx(0.45, rel=1e-12)
    assert material.friction == 0.4
    # Written out it has the moduli, to the last bit.
    assert design_from_toml(design_to_toml(design_from_toml(text))).material == material


def test_kinetic_friction_is_the_static_one_where_a_file_does_not_say(tmp_path: Path) -> None:
    """Files of before there were two coefficients mean the same; with two, both come back."""
    old = design_from_toml(HEAD + "friction = 0.4\n").material
    assert (old.friction, old.kinetic_friction, old.sliding_friction) == (0.4, None, 0.4)
    both = design_from_toml(HEAD + "friction = 0.4\nkinetic_friction = 0.25\n")
    assert both.material.sliding_friction == 0.25
    assert design_from_toml(design_to_toml(both)).material == both.material


@pytest.mark.parametrize(
    ("lines", "at", "says"),
    [
        ("c10_MPa = 0.025", "material.d1_per_MPa", "need each other"),
        ("d1_per_MPa = 4.1", "material.c10_MPa", "need each other"),
        ("c10_MPa = 0.025\nd1_per_MPa = 4.1\npoisson = 0.4", "material.poisson", "the same"),
        ("c10_MPa = -1.0\nd1_per_MPa = 4.1", "material.c10_MPa", "-1 MPa"),
        ("c10_MPa = true\nd1_per_MPa = 4.1", "material.c10_MPa", "True"),
        ("c10_MPa = 0.025\nd1_per_MPa = 1e-4", "material.poisson", "0.495"),
        ('law = "hook"', "material.law", "'hook'"),
        ("friction = 0.3\nkinetic_friction = 0.4", "material.kinetic_friction", "outside 0 to 0.3"),
        ("[[material.inclusions]]\nwhere = 'cube'", "material.inclusions", "'cube'"),
    ],
)
def test_bad_materials_are_refused_with_their_field(lines: str, at: str, says: str) -> None:
    """One message with the value, the field and a remedy."""
    with pytest.raises(DesignError, match=says) as caught:
        design_from_toml(HEAD + lines + "\n")
    assert caught.value.at.startswith(at)
    assert caught.value.hint
