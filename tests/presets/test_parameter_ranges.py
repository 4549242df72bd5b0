"""Ends of every parameter's range: inside they build or are refused, just past them always."""

from __future__ import annotations

import dataclasses
import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from designs.family import Slider, families, family, resolve_shape, sliders
from geometry.surface.surface import is_watertight
from workbench.core.base.errors import DesignError, GeometryError
from workbench.core.base.monitor import silent
from workbench.core.design.design import Layers
from workbench.pipeline.stages.build import BuildInputs, build

NAMES = sorted(families())
BUILT = [name for name in NAMES if name != "imported"]
"""Families that make a body from their parameters alone."""
LAYERS = Layers()


def just_past(slider: Slider, *, upper: bool) -> float:
    """The next number beyond an end of the range."""
    end = slider.maximum if upper else slider.minimum
    return float(np.nextafter(end, np.inf if upper else -np.inf))


def expect_clear(error: DesignError, *words: str) -> None:
    """A message with these words, a remedy, and a field of the design."""
    for word in words:
        assert word in error.message
    assert error.hint
    assert error.at.partition(".")[0] in ("shape", "layers")


@pytest.mark.parametrize("name", NAMES)
def test_just_past_either_end_is_refused(name: str) -> None:
    """Refused at its own field, with the range and its unit, as far as one rounding error."""
    for slider in sliders(name):
        for upper in (False, True):
            value = just_past(slider, upper=upper)
            with pytest.raises(DesignError) as caught:
                resolve_shape(name, {slider.name: value})
            span = f"{slider.minimum:g} to {slider.maximum:g}"
            expect_clear(caught.value, slider.label, span, slider.unit)
            assert caught.value.at == f"shape.{slider.name}"


@pytest.mark.parametrize("name", NAMES)
def test_an_end_is_taken_or_contradicts_another_value(name: str) -> None:
    """Each end, alone and with all others at the same end: no error but one with a remedy."""
    taken = 0
    for slider in sliders(name):
        for value in (slider.minimum, slider.maximum):
            try:
                family(name).check(resolve_shape(name, {slider.name: value}), LAYERS)
                taken += 1
            except DesignError as error:
                expect_clear(error)
    # A range whose ends contradict the defaults more often than not would be no range.
    assert taken > len(sliders(name))
    for ends in ("minimum", "maximum"):
        values = {slider.name: getattr(slider, ends) for slider in sliders(name)}
        try:
            family(name).check(resolve_shape(name, values), LAYERS)
        except DesignError as error:
            expect_clear(error)


@pytest.mark.parametrize("field", [field.name for field in dataclasses.fields(Layers)])
def test_a_wall_of_no_thickness_is_refused(field: str) -> None:
    """0 mm, a negative wall and none at all: refused with the least that is possible."""
    for value in (0.0, -1.0, float("nan"), float("inf")):
        with pytest.raises(DesignError) as caught:
            Layers(**{field: value})
        assert ("0.2" in caught.value.message) == bool(np.isfinite(value))
        assert caught.value.at == f"layers.{field}"
        assert caught.value.hint


@pytest.mark.slow
@pytest.mark.parametrize("name", BUILT)
def test_bodies_at_sampled_ends_are_whole(name: str) -> None:
    """Four ends drawn with a fixed seed: one closed body each, or a refusal with a remedy."""
    random = np.random.default_rng(len(name))
    ends = [(s.name, value) for s in sliders(name) for value in (s.minimum, s.maximum)]
    for number in random.choice(len(ends), 4, replace=False):
        key, value = ends[number]
        try:
            solid = build(
                BuildInputs(family=name, shape=resolve_shape(name, {key: value}), layers=LAYERS),
                monitor=silent,
            )
        except (DesignError, GeometryError) as error:
            assert error.hint, (key, value)
            continue
        assert solid.volume_mm3 > 0.0, (key, value)
        assert is_watertight(solid.membrane.faces), (key, value)


@pytest.mark.slow
def test_a_fillet_on_too_steep_a_saddle_is_made_smaller_and_told() -> None:
    """Rim of 4 mm at a slope of 55 degrees: 3/4 of it, a notice with both, and a closed body."""
    shape = resolve_shape("trunk", {"lobe_mm": 5.75, "rim_mm": 4.0})
    solid = build(BuildInputs(family="trunk", shape=shape, layers=Layers()), monitor=silent)
    assert is_watertight(solid.membrane.faces)
    assert solid.notice == "Rim radius 4 mm could not be built; 3 mm was"


@pytest.mark.parametrize(
    ("table", "says"),
    [
        ("[layers]\nelastomer_mm = 0.0\n", "elastomer wall 0 mm is outside 0.2 to 20 mm"),
        ("[shape]\nrim_mm = 5.0\n", "Rim radius 5 mm is outside 0.5 to 4 mm"),
    ],
)
def test_the_command_names_value_limit_and_remedy(tmp_path: Path, table: str, says: str) -> None:
    """Exit 2 and one message with a hint on stderr; nothing is written."""
    file, out = tmp_path / "design.toml", tmp_path / "out"
    file.write_text(f'schema = 1\nname = "bad"\nfamily = "trunk"\n{table}')
    words = [sys.executable, "-m", "workbench.cli", "export", file, "--out", out, "--json"]
    words += ["--project", tmp_path / "project"]
    done = subprocess.run([str(w) for w in words], capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert "Traceback" not in done.stderr
    assert says in done.stderr
    assert "hint: " in done.stderr
    assert json.loads(done.stdout.splitlines()[-1])["error"] == "DesignError"
    assert not list(out.glob("*"))
