"""Numbers that Python and the path tracer's GLSL share: how hits, wavefronts and the scene buffer are laid out.

They are written down here alone. GLSL gets each as a define of the same name, by `shader_defines`.
"""

from __future__ import annotations

from collections.abc import Mapping

from .kinds import FINISH, FIRST_HIT, KINDS, NO_KIND, REST, SHADE
from .scene.materials import MAP_WORDS

TILE = 16
"""Paths of a block of a wavefront, and pixels of a tile of the picture, along each side."""

IDLE, IN_FLIGHT, ENDED = 0, 1, 2
"""The status of a path, in w of its origin: nothing to do; a ray to be traced; only its shadow ray is pending."""

# x of a hit: is the shadow ray free? << 31 | kind << KIND_SHIFT | instance (shaders/trace/hit.glsl)
KIND_SHIFT = 28
INSTANCE_MASK = (1 << KIND_SHIFT) - 1
FREE = 1 << 31
MISS = NO_KIND << KIND_SHIFT | INSTANCE_MASK

SCENE_WIDTH = 4096
"""Texels in a row of the scene buffer."""
INSTANCE_TEXELS = 5
"""Of an instance in the scene buffer: the rows of mesh-to-tracer; first triangle, first vertex, material, first emitter
(-1 for none); flags, medium inside, 0, 0."""

SEE_THROUGH, MIRRORED, DOUBLE_SIDED, UNLIT, THIN = 1, 2, 4, 8, 16
"""Bits of an instance's flags."""


def vertex_layout(switches: Mapping[str, int]) -> dict[str, int]:
    """Where in a vertex's texels its attributes are, and how many texels it has.

    Position and u are in the first, normal and v in the second; then come a tangent, second texture coordinates and a
    colour, those of them that the switches say are used.
    """
    has_tangent, has_uv1, has_color = (switches.get(name, 0) for name in ("HAS_TANGENT", "HAS_UV1", "HAS_COLOR"))
    return {"VERTEX_TANGENT": 2, "VERTEX_UV1": 2 + has_tangent, "VERTEX_COLOR": 2 + has_tangent + has_uv1,
            "VERTEX_TEXELS": 2 + has_tangent + has_uv1 + has_color}


_CONSTANTS = {
    "TILE": TILE,
    "IDLE": IDLE, "IN_FLIGHT": IN_FLIGHT, "ENDED": ENDED,
    "KIND_SHIFT": KIND_SHIFT, "NO_KIND": NO_KIND, **{f"KIND_{kind.name.upper()}": kind.number for kind in KINDS},
    "CLASS_REST": REST, "CLASS_FINISH": FINISH, "CLASS_FIRST_HIT": FIRST_HIT, "CLASS_SHADE": SHADE,
    "SCENE_WIDTH": SCENE_WIDTH, "INSTANCE_TEXELS": INSTANCE_TEXELS, "MAP_TEXELS": MAP_WORDS,
    "FLAG_SEE_THROUGH": SEE_THROUGH, "FLAG_MIRRORED": MIRRORED, "FLAG_DOUBLE_SIDED": DOUBLE_SIDED, "FLAG_UNLIT": UNLIT,
    "FLAG_THIN": THIN,
}


def shader_defines(switches: Mapping[str, int] | None = None) -> dict[str, int]:
    """The defines of a program of shaders/trace: its own `switches`, and the numbers of this module."""
    switches = switches or {}
    return {**_CONSTANTS, **vertex_layout(switches), **switches}
