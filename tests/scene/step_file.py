"""Writes STEP files (ISO 10303-21, AP214) of convex solids with plane faces."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

_HEAD = """ISO-10303-21;
HEADER;
FILE_DESCRIPTION((''),'2;1');
FILE_NAME('','2026-01-01T00:00:00',(''),(''),'','','');
FILE_SCHEMA(('AUTOMOTIVE_DESIGN { 1 0 10303 214 1 1 1 1 }'));
ENDSEC;
DATA;
"""
BOX = ((0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7))


def box(size: Sequence[float]) -> np.ndarray:
    """The corners (8, 3) of a box from the origin, in the order that BOX counts on."""
    return np.array([(x, y, z) for z in (0, 1) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))], float) * size


def step(corners: np.ndarray, faces: Sequence[Sequence[int]] = BOX, color: Sequence[float] | None = None,
         unit: str = "SI_UNIT(.MILLI.,.METRE.)") -> bytes:
    """A solid; `faces` list their corners counter-clockwise, seen from outside."""
    lines: list[str] = []

    def add(text: str) -> str:
        lines.append(f"#{len(lines) + 1}={text};")
        return f"#{len(lines)}"

    def listed(items: Sequence[str]) -> str:
        return f"({','.join(items)})"

    def triple(kind: str, values: Sequence[float]) -> str:
        return add(f"{kind}('',({','.join(f'{value:.6f}' for value in values)}))")

    points = [triple("CARTESIAN_POINT", corner) for corner in corners]
    vertices = [add(f"VERTEX_POINT('',{point})") for point in points]
    edges: dict[tuple[int, int], str] = {}
    advanced = []
    for face in faces:
        ends = list(zip(face, (*face[1:], face[0])))
        for a, b in ends:
            if (b, a) not in edges:
                along = corners[b] - corners[a]
                length = float(np.linalg.norm(along))
                vector = add(f"VECTOR('',{triple('DIRECTION', along / length)},{length:.6f})")
                line = add(f"LINE('',{points[a]},{vector})")
                edges[a, b] = add(f"EDGE_CURVE('',{vertices[a]},{vertices[b]},{line},.T.)")
        loop = [add(f"ORIENTED_EDGE('',*,*,{edges[a, b]},.T.)" if (a, b) in edges
                    else f"ORIENTED_EDGE('',*,*,{edges[b, a]},.F.)") for a, b in ends]
        bound = add(f"FACE_OUTER_BOUND('',{add(f'EDGE_LOOP({chr(39) * 2},{listed(loop)})')},.T.)")
        x = corners[face[1]] - corners[face[0]]
        normal = np.cross(x, corners[face[2]] - corners[face[1]])
        place = add(f"AXIS2_PLACEMENT_3D('',{points[face[0]]},{triple('DIRECTION', normal / np.linalg.norm(normal))},"
                    f"{triple('DIRECTION', x / np.linalg.norm(x))})")
        plane = add(f"PLANE('',{place})")
        advanced.append(add(f"ADVANCED_FACE('',({bound}),{plane},.T.)"))
    solid = add(f"MANIFOLD_SOLID_BREP('solid',{add(f'CLOSED_SHELL({chr(39) * 2},{listed(advanced)})')})")
    length_unit = add(f"(LENGTH_UNIT() NAMED_UNIT(*) {unit})")
    angle = add("(NAMED_UNIT(*) PLANE_ANGLE_UNIT() SI_UNIT($,.RADIAN.))")
    solid_angle = add("(NAMED_UNIT(*) SI_UNIT($,.STERADIAN.) SOLID_ANGLE_UNIT())")
    fuzz = add(f"UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE(1.E-07),{length_unit},'','')")
    context = add(f"(GEOMETRIC_REPRESENTATION_CONTEXT(3) GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT(({fuzz})) "
                  f"GLOBAL_UNIT_ASSIGNED_CONTEXT(({length_unit},{angle},{solid_angle})) REPRESENTATION_CONTEXT('',''))")
    shape = add(f"ADVANCED_BREP_SHAPE_REPRESENTATION('',({solid}),{context})")
    application = add("APPLICATION_CONTEXT('')")
    product = add(f"PRODUCT('part','part','',({add(f'PRODUCT_CONTEXT({chr(39) * 2},{application},{chr(39) * 2})')}))")
    formation = add(f"PRODUCT_DEFINITION_FORMATION('','',{product})")
    design = add(f"PRODUCT_DEFINITION_CONTEXT('part definition',{application},'design')")
    definition = add(f"PRODUCT_DEFINITION('design','',{formation},{design})")
    defined = add(f"PRODUCT_DEFINITION_SHAPE('','',{definition})")
    add(f"SHAPE_DEFINITION_REPRESENTATION({defined},{shape})")
    if color is not None:
        rgb = add(f"COLOUR_RGB('',{','.join(f'{part:.6f}' for part in color)})")
        fill = add(f"FILL_AREA_STYLE('',({add(f'FILL_AREA_STYLE_COLOUR({chr(39) * 2},{rgb})')}))")
        side = add(f"SURFACE_SIDE_STYLE('',({add(f'SURFACE_STYLE_FILL_AREA({fill})')}))")
        style = add(f"PRESENTATION_STYLE_ASSIGNMENT(({add(f'SURFACE_STYLE_USAGE(.BOTH.,{side})')}))")
        styled = add(f"STYLED_ITEM('',({style}),{solid})")
        add(f"MECHANICAL_DESIGN_GEOMETRIC_PRESENTATION_REPRESENTATION('',({styled}),{context})")
    return (_HEAD + "\n".join(lines) + "\nENDSEC;\nEND-ISO-10303-21;\n").encode()
