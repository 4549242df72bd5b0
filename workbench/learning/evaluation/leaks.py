"""That nothing is scored on what the weights were trained on.

The data card says which recipe the training set followed. The split of a case follows from the
recipe alone, however many of its cases were made, so the cases of *test* and *unseen* of the same
recipe were never trained on. Another Young's modulus changes neither the order of cases nor the
split: there the recipe must be that of the card but for the material. Of any other set only objects
that no training showed may be used, as the card names those that one did.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from sim.forces.acquaintance import membranes_of
from sim.forces.network.weights import NetworkWeights
from workbench.core.base.errors import DesignError
from workbench.learning.dataset.cases import Case, Split
from workbench.learning.dataset.recipe import table_key
from workbench.learning.evaluation.sources import HELD_OUT, Source


def expect_no_leak(
    weights: NetworkWeights, source: Source, cases: Iterable[Case], *, name: str
) -> None:
    """Check that the weights never saw any of the cases.

    Args:
        weights: With their data card.
        source: Whose cases they are.
        cases: To be scored.
        name: Of the weights, for messages.

    Raises:
        DesignError: If one was trained on, or nothing says that it was not.
    """
    cases = list(cases)
    trained = [case.id for case in cases if case.split not in HELD_OUT]
    if trained:
        raise _refused(f"{trained[0]} is a case of the training of {name}", len(trained))
    card = weights.card
    shown = {str(kind) for kind in card.get("indenters", ())}
    known = [case.id for case in cases if case.split is Split.UNSEEN and case.indenter in shown]
    if known:
        raise _refused(f"the object of {known[0]} was shown to {name} in training", len(known))
    if not shown and any(case.split is Split.UNSEEN for case in cases):
        raise _refused(f"the data card of {name} does not say which objects it was shown", 0)
    mixed = [case.id for case in cases if case.split is Split.TEST]
    if mixed and not same_deal(card, source.manifest["recipe"], source.key):
        raise _refused(
            f"nothing says that {name} was not trained on {mixed[0]}: it was trained on data set "
            f"{', '.join(key[:12] for key in dataset_keys(card)) or 'unknown'}, this is "
            f"{source.key[:12]}",
            len(mixed),
        )


def dataset_keys(card: Mapping[str, Any]) -> list[str]:
    """Keys of the data sets that were trained on; several belong together by the same split."""
    dataset = card.get("dataset", {})
    found = dataset.get("keys") or [dataset.get("key", "")]
    return [str(key) for key in found if key]


def same_deal(card: Mapping[str, Any], recipe: Mapping[str, Any], key: str) -> bool:
    """Whether a recipe deals its cases as that of a training set did."""
    trained, material = dataset_keys(card), _material(card)
    if key in trained:
        return True
    if not material:
        return False
    design = {**recipe["design"], "material": {**recipe["design"]["material"], **material}}
    # Images have a part in the key and none in the deal.
    tables = ({**recipe, "design": design, "images": images} for images in (True, False))
    return any(table_key(table) in trained for table in tables)


def _material(card: Mapping[str, Any]) -> dict[str, Any]:
    """Numbers of the material of the training set, as far as the card has them."""
    for membrane in membranes_of(card):
        material = membrane["design"].get("material")
        if isinstance(material, Mapping):
            return dict(material)
    return {name: card[name] for name in ("young_MPa", "poisson", "friction") if name in card}


def _refused(message: str, count: int) -> DesignError:
    more = f" ({count} cases in all)" if count > 1 else ""
    return DesignError(
        message + more,
        hint="evaluate on the data set that the weights were trained on, whose split keeps test "
        "cases apart, or on a set of objects that they never saw",
        at="--weights",
    )
