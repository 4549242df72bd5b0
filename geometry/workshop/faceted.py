"""Triangles as the STEP file of one solid of planar facets, written as text.

Used where a body exists only as triangles (signed-distance fallback, imported bodies, tapered
cores). A `faceted_brep` of ISO 10303-42 in AP214, whose facets share their corners: OCCT takes
seven times as long to write the same facets as curves and surfaces, and twice as long to read them.
"""

from __future__ import annotations

import numpy as np

from geometry.workshop.thinning import thinned

STAMP = "2000-01-01T00:00:00"
"""Same bytes for the same body."""
HEAD = """ISO-10303-21;
HEADER;
FILE_DESCRIPTION(('{about}'),'2;1');
FILE_NAME('{name}','{stamp}',(''),(''),'sensor workbench','sensor workbench','');
FILE_SCHEMA(('AUTOMOTIVE_DESIGN {{ 1 0 10303 214 1 1 1 1 }}'));
ENDSEC;
DATA;
"""
TAIL = "ENDSEC;\nEND-ISO-10303-21;\n"
PRODUCT = """\
#1=APPLICATION_PROTOCOL_DEFINITION('international standard','automotive_design',2000,#2);
#2=APPLICATION_CONTEXT('core data for automotive mechanical design processes');
#3=SHAPE_DEFINITION_REPRESENTATION(#4,#10);
#4=PRODUCT_DEFINITION_SHAPE('','',#5);
#5=PRODUCT_DEFINITION('design','',#6,#9);
#6=PRODUCT_DEFINITION_FORMATION('','',#7);
#7=PRODUCT('{name}','{name}','',(#8));
#8=PRODUCT_CONTEXT('',#2,'mechanical');
#9=PRODUCT_DEFINITION_CONTEXT('part definition',#2,'design');
#10={shape};
#11=AXIS2_PLACEMENT_3D('',#12,#13,#14);
#12=CARTESIAN_POINT('',(0.,0.,0.));
#13=DIRECTION('',(0.,0.,1.));
#14=DIRECTION('',(1.,0.,0.));
#20=(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT((#24))\
GLOBAL_UNIT_ASSIGNED_CONTEXT((#21,#22,#23))REPRESENTATION_CONTEXT('',''));
#21=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.));
#22=(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.));
#23=(NAMED_UNIT(*)SI_UNIT($,.STERADIAN.)SOLID_ANGLE_UNIT());
#24=UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE(1.E-06),#21,'distance_accuracy_value','');
"""
FIRST = 100
"""First number of what is not the same in every file."""


def faceted_step(points_mm: np.ndarray, faces: np.ndarray, *, name: str) -> tuple[bytes, float]:
    """The STEP file of a closed mesh, thinned out where it has many triangles.

    Args:
        points_mm: Vertices [mm], shape (N, 3).
        faces: Triangles, shape (M, 3), counter-clockwise from outside.
        name: Of the part: letters, digits and underscores.

    Returns:
        The file, and the largest distance of its facets from the mesh [mm].

    Raises:
        GeometryError: If it is not closed, or few enough facets would be another body.
    """
    points, triangles, far_mm = thinned(points_mm, faces, what=name)
    about = f"flat facets, at most {far_mm:.3f} mm from the mesh"
    shape = "FACETED_BREP_SHAPE_REPRESENTATION('',(#11,#15),#20)"
    text = HEAD.format(about=about, name=name, stamp=STAMP) + PRODUCT.format(name=name, shape=shape)
    return (text + _solid_text(points, triangles) + TAIL).encode("ascii"), far_mm


def _solid_text(points: np.ndarray, faces: np.ndarray) -> str:
    """The entities of one solid: a corner a line, then a facet a line."""
    # What a reader sees are these digits, so planes are those through the rounded corners.
    points = np.round(points, 7)
    corners = points[faces]
    along = corners[:, 1] - corners[:, 0]
    normal = np.cross(along, corners[:, 2] - corners[:, 0])
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    lines = [
        f"#{FIRST + number}=CARTESIAN_POINT('',{_numbers(point, 7)});"
        for number, point in enumerate(points.tolist())
    ]
    shell, n = [], FIRST + len(points)
    rows = zip((faces + FIRST).tolist(), normal.tolist(), along.tolist(), strict=True)
    for (a, b, c), up, over in rows:
        lines.append(
            f"#{n}=POLY_LOOP('',(#{a},#{b},#{c}));#{n + 1}=FACE_OUTER_BOUND('',#{n},.T.);"
            f"#{n + 2}=DIRECTION('',{_numbers(up, 12)});"
            f"#{n + 3}=DIRECTION('',{_numbers(over, 12)});"
            f"#{n + 4}=AXIS2_PLACEMENT_3D('',#{a},#{n + 2},#{n + 3});#{n + 5}=PLANE('',#{n + 4});"
            f"#{n + 6}=FACE_SURFACE('',(#{n + 1}),#{n + 5},.T.);"
        )
        shell.append(f"#{n + 6}")
        n += 7
    # One facet a line, because some readers limit a line's length.
    lines.append(f"#16=CLOSED_SHELL('',({chr(10)}{f',{chr(10)}'.join(shell)}));")
    lines.append("#15=FACETED_BREP('',#16);\n")
    return "\n".join(lines)


def _numbers(values: list[float], digits: int) -> str:
    x, y, z = values
    return f"({x:.{digits}f},{y:.{digits}f},{z:.{digits}f})"
