"""What designers read for objects that press, and the headings under which they stand.

Files and command line keep the names of the kinds.
"""

from __future__ import annotations

from workbench.core.objects.kind import Group, Kind

HEADINGS = {
    Group.SEEN: "Shapes of the paper that its networks were trained with",
    Group.UNSEEN: "Shapes of the paper kept for tests of its networks",
    Group.OTHER: "Further shapes",
    Group.RELEASED: "Heads released with the paper, in their own sizes",
}
EVERYDAY = "Everyday objects"


def object_words(name: str, record: Kind | None = None) -> str:
    """An object in words; a released head with its size.

    Args:
        name: Of the kind or of the everyday object.
        record: What the kind says of itself; None of an everyday object.
    """
    if record is None or record.own_mm is None:
        return name.replace("_", " ")
    plain = name.removeprefix(f"{record.group}_").replace("_", " ")
    return f"{plain}, {record.own_mm:.3g} mm"


def heading(record: Kind | None) -> str:
    """Where an object stands in the gallery; None of an everyday object."""
    return EVERYDAY if record is None else HEADINGS[record.group]
