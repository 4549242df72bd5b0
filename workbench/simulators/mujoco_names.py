"""What in a MuJoCo model is meant by a name or a number."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from workbench.core.base.errors import DesignError, shown
from workbench.core.base.mapping import suggest
from workbench.simulators.mujoco_module import MjModel


def body_number(model: MjModel, body: str | int) -> int:
    """Number of a body.

    Raises:
        DesignError: If there is none of that name or number.
    """
    return _number(body, [model.body(i).name for i in range(model.nbody)], "body")


def geom_numbers(model: MjModel, geoms: str | int | Sequence[str | int]) -> list[int]:
    """Numbers of geoms, one or several.

    Raises:
        DesignError: If there is none of a name or number, or none at all is asked for.
    """
    asked = [geoms] if isinstance(geoms, str | int) else list(geoms)
    if not asked:
        raise DesignError("no geoms are named", hint="name what the sensor may touch", at="geoms")
    names = [model.geom(i).name for i in range(model.ngeom)]
    return [_number(geom, names, "geoms") for geom in asked]


def _number(asked: str | int, names: Sequence[str], at: str) -> int:
    if isinstance(asked, str) and asked in names:
        return names.index(asked)
    if not isinstance(asked, str) and 0 <= asked < len(names):
        return int(asked)
    raise DesignError(
        f"the model has no {at.removesuffix('s')} {shown(asked)}",
        hint=suggest(str(asked), filter(None, names)),
        at=at,
    )


def fixed_below(model: MjModel, body: int) -> set[int]:
    """A body and those below it that no joint lets move against it."""
    found = {body}
    for other in range(body + 1, model.nbody):
        if int(model.body_parentid[other]) in found and not model.body_jntnum[other]:
            found.add(other)
    return found


def by_body(model: MjModel, geoms: Iterable[int]) -> dict[int, list[int]]:
    """Geoms by the body that they belong to."""
    found: dict[int, list[int]] = {}
    for geom in geoms:
        found.setdefault(int(model.geom_bodyid[geom]), []).append(geom)
    return found
