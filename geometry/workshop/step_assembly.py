"""Several STEP files as one assembly, by their text.

The entities of each file keep their order and get numbers of their own; a product above all names
each of them as a component that stands where it is. Nothing is read by the CAD kernel, which takes
as long for an assembly as for all its parts.
"""

from __future__ import annotations

import re
from collections.abc import Mapping

from geometry.workshop.faceted import FIRST, HEAD, PRODUCT, STAMP, TAIL
from workbench.core.base.errors import GeometryError

REFERENCE = re.compile(r"#(\d+)")
STRING = re.compile(r"('(?:[^']|'')*')")


def assembly_step(name: str, parts: Mapping[str, bytes]) -> bytes:
    """One STEP file of named parts, each where it is in its own file.

    Args:
        name: Of the assembly.
        parts: STEP file of each part by its name.

    Raises:
        GeometryError: If a file holds no product.
    """
    shape = "SHAPE_REPRESENTATION('',(#11),#20)"
    texts = [HEAD.format(about=f"assembly of {len(parts)} parts", name=name, stamp=STAMP)]
    texts.append(PRODUCT.format(name=name, shape=shape))
    free = FIRST
    for number, (part, data) in enumerate(parts.items(), 1):
        entities, free = _renumbered(data.decode("latin-1"), free)
        product = _first(r"#(\d+)\s*=\s*PRODUCT_DEFINITION\(", entities, part)
        shape_of = r"SHAPE_DEFINITION_REPRESENTATION\(\s*#\d+,\s*#(\d+)"
        placed = _first(shape_of, entities, part)
        texts.append(entities)
        texts.append(
            f"#{free}=NEXT_ASSEMBLY_USAGE_OCCURRENCE('{number}','{part}','',#5,#{product},$);\n"
            f"#{free + 1}=PRODUCT_DEFINITION_SHAPE('Placement','',#{free});\n"
            f"#{free + 2}=ITEM_DEFINED_TRANSFORMATION('','',#11,#11);\n"
            f"#{free + 3}=(REPRESENTATION_RELATIONSHIP('','',#{placed},#10)"
            f"REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION(#{free + 2})"
            "SHAPE_REPRESENTATION_RELATIONSHIP());\n"
            f"#{free + 4}=CONTEXT_DEPENDENT_SHAPE_REPRESENTATION(#{free + 3},#{free + 1});\n"
        )
        free += 5
    return ("".join(texts) + TAIL).encode("latin-1")


def _renumbered(text: str, first: int) -> tuple[str, int]:
    """The entities of a file with numbers from `first` on, and the first number after them."""
    body = text.partition("DATA;")[2].rpartition("ENDSEC;")[0].lstrip()
    # Every second piece is a string, in which a hash is a hash.
    pieces = STRING.split(body)
    last = first
    for place in range(0, len(pieces), 2):
        numbers = REFERENCE.findall(pieces[place])
        last = max(last, *(first + int(number) for number in numbers)) if numbers else last
        pieces[place] = REFERENCE.sub(lambda hit: f"#{first + int(hit[1])}", pieces[place])
    return "".join(pieces), last + 1


def _first(pattern: str, text: str, part: str) -> str:
    """What a pattern finds first: a file names its whole before its components."""
    found = re.search(pattern, text)
    if found is None:
        raise GeometryError(
            f"the STEP file of {part} holds no product", hint="use its STL or 3MF file", at="mould"
        )
    return found[1]
