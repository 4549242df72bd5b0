"""Keys: stable, narrow, and different when anything that matters differs."""

from __future__ import annotations

import dataclasses
import subprocess
import sys

import numpy as np
import pytest

from workbench.core.base.digest import digest
from workbench.core.design.camera import Camera
from workbench.core.design.design import Elastomer, SensorDesign


def test_equal_values_have_equal_keys() -> None:
    """digest(x) == digest(copy of x)."""
    assert digest(Camera()) == digest(dataclasses.replace(Camera()))
    assert digest({"a": 1, "b": 2.0}) == digest({"b": 2.0, "a": 1})


@pytest.mark.parametrize(
    ("one", "other"),
    [
        (1, 1.0),
        (True, 1),
        (0.3, 0.1 + 0.2),
        ("1", 1),
        ((1, 2), ((1,), 2)),
        ("ab", ("a", "b")),
        (np.zeros(2, np.float32), np.zeros(2)),
        (np.zeros((2, 3)), np.zeros((3, 2))),
        ({"a": 1}, {"b": 1}),
        (Camera(), Camera(fov_x_deg=99.0)),
        (None, "None"),
    ],
)
def test_different_values_have_different_keys(one: object, other: object) -> None:
    """No collision between types, shapes, nestings or nearly equal floats."""
    assert digest(one) != digest(other)


def test_cosmetic_fields_do_not_change_the_key() -> None:
    """Renaming a design, or citing another source, recomputes nothing."""
    assert digest(SensorDesign(name="a")) == digest(SensorDesign(name="b"))
    assert digest(Elastomer(source="x")) == digest(Elastomer(source="y"))


def test_unknown_types_raise() -> None:
    """A type without a canonical form is refused instead of hashed by address."""
    with pytest.raises(TypeError, match="set"):
        digest({1, 2})


def test_key_is_the_same_in_another_process() -> None:
    """Nothing of the process (hash seed, addresses) reaches the key."""
    code = (
        "from workbench.core.base.digest import digest;"
        "from workbench.core.design.design import SensorDesign; print(digest(SensorDesign()))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == digest(SensorDesign())
