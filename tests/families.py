"""What every family owes: refusals with their place, and no trust in the kernel."""

from __future__ import annotations

from typing import Any

import pytest

from designs.family import family, resolve_shape
from workbench.core.base.errors import DesignError, GeometryError
from workbench.core.design.design import Layers


def expect_refusal(name: str, shape: dict[str, float], layers: dict[str, float], at: str) -> None:
    """The family refuses, naming value, limit and unit, and what to change."""
    with pytest.raises(DesignError) as caught:
        family(name).check(resolve_shape(name, shape), Layers(**layers))
    assert caught.value.at == at
    assert caught.value.hint
    assert any(letter.isdigit() for letter in caught.value.message)


def expect_found_out(
    monkeypatch: pytest.MonkeyPatch,
    design: str | tuple[str, dict[str, float]],
    layers: Layers,
    broken: tuple[Any, str, str],
    says: str,
) -> None:
    """A boolean that returns the uncut body is found out by the family's own check.

    Args:
        design: The family in its default shape, or with values of its own.
        broken: Module, name of its boolean, and the beginning of the feature's name.
    """
    module, boolean, feature = broken
    real = getattr(module, boolean)

    def lazy(body: Any, tool: Any, *, what: str, **rest: Any) -> Any:
        return body if what.startswith(feature) else real(body, tool, what=what, **rest)

    monkeypatch.setattr(module, boolean, lazy)
    name, shape = design if isinstance(design, tuple) else (design, {})
    with pytest.raises(GeometryError, match=says):
        family(name).build(resolve_shape(name, shape), layers)
