"""Numbers that Python and the path tracer's GLSL share: how hits, wavefronts and the scene buffer are laid out.

They are defined here only. GLSL gets each of them as a define (viewer/trace/defines.py), but for those that are
unsigned there: INSTANCE_MASK, FREE, MISS and LIGHT_LEAF.
"""

from __future__ import annotations

from collections.abc import Mapping

TILE = 16
"""Side of a block of paths in a wavefront, and of a tile of pixels in the picture."""

IDLE, IN_FLIGHT, ENDED = 0, 1, -1
"""The status of a path, the sign of w of its origin: it has no ray; it has a ray; it has ended and at most a shadow ray
is pending."""

CLASS_IDLE, CLASS_ENDED, CLASS_FIRST_HIT, CLASS_SHADE = range(4)
CLASS_MEDIUM, CLASS_AIRLIGHT, CLASS_FIRST_COLLISION = 10, 11, 12
"""The classes of paths. Each pass shades the paths of one class.

A path is idle; or it has ended; or its camera ray has hit a surface, for the pass that collects layers; or it has hit a
surface of kind k, which is class CLASS_SHADE + k, below CLASS_MEDIUM. In a medium that scatters it may collide before
it gets to a surface; or it collects light that is scattered on its way there, before it goes on. For the layers again,
a camera ray that hits no surface may collide.
"""

LEFT_BITS = 10
"""Bits of the number of samples that a path has left (shaders/trace/state.glsl)."""

MAX_LAYERS = 64
"""A shadow ray that has passed this many surfaces counts as occluded."""

NO_KIND = 7
"""The kind of surface in the hit of a ray that missed; see viewer/trace/kinds.py."""

# x of a hit: shadow ray is unoccluded << 31 | kind << KIND_SHIFT | instance (shaders/trace/hit.glsl)
KIND_SHIFT = 28
INSTANCE_MASK = (1 << KIND_SHIFT) - 1
FREE = 1 << 31
MISS = NO_KIND << KIND_SHIFT | INSTANCE_MASK

FAR = 4.0
"""The distance, in tracer units, that a ray travels in its medium if it leaves the scene without a hit.

Light samples of the environment and of directional lights travel as far, so that both techniques agree. All geometry
lies within |p| <= 1.
"""
MEDIA_REACH = 4.0
"""In scenes with scattering, media end at this distance from the centre, in tracer units. `FAR` is then twice that."""
CLEARANCE_STEPS = 4.0
"""Steps, in the side of a cell, of the distances in the grid of shaders/media/clearance.glsl. A byte holds one."""
MOST_STEPS = 8000
"""A path that has so many collisions in media, and would go on, is left out of the picture and counted. The counter of
shaders/trace/state.glsl holds a few more."""

THINS_FROM, THINS_EVERY = 2048, 384
"""After so many collisions the mean free path of a path grows, and doubles every so many (trace/endless.glsl)."""
HURRIES_FROM, HURRIES_EVERY = 6656, 24
"""After so many it doubles, besides, every so many: any path has left the scene before it has `MOST_STEPS`."""

INSTANCE_TEXELS = 5
"""Texels of an instance in the scene buffer.

Three have the rows of the matrix from mesh to tracer space; one has the first triangle, first vertex, material and
first emitter (-1 for none); one has the flags, the medium inside, 0, 0.
"""

VOLUME_TEXELS = 8
"""Texels of a volume in the scene buffer (shaders/media/grid.glsl).

Three have the rows of the matrix from tracer space to cells; one has the voxels along each axis and the first row of
the densities in their texture; one has the cells along each axis and the first row of the majorants; one has the voxels
along the side of a cell, the extinction of the density 1 per tracer unit (float bits), 0, 0; one has the albedo and the
number of the phase function (`Medium.phase`); one has emission over extinction, and 0.
"""

FIBRE_TEXELS = 2
"""Texels of a set of curves in the scene buffer: absorption and beta_m; beta_n, tilt, index of refraction, 0."""

LIGHT_NODE_TEXELS = 2
"""Texels of a node of the tree of lights in the scene buffer.

One has the centre and the radius of a sphere; one has the intensity; the axis of a cone, 16 bits for each of two
coordinates; the cosine of its half angle in LIGHT_COSINE_STEPS from -1 to 1, the flags from bit LIGHT_FLAG_SHIFT on,
and the reach from bit 16 on; the link (viewer/trace/scene/light_tree.py).
"""
LIGHT_LEAF = 1 << 31
"""Set in the link of a single light, whose number it holds; else the link is the number of a pair of nodes."""
MOST_LIGHT_LEVELS = 32
"""Levels of the tree of lights below the root: the way to a light is a bit for each of them."""
LIGHT_COSINE_STEPS, LIGHT_FLAG_SHIFT = (1 << 13) - 1, 13
LIGHT_LAMP, LIGHT_TWO_SIDED, LIGHT_NARROW = 1, 2, 4
"""Flags: some of the lights are lamps; the cone is a double cone; all are spots, without light beyond their cone."""
LIGHT_REACH_STEPS, LIGHT_REACH_LOW = 1024, 32
"""A reach is 2^(k / LIGHT_REACH_STEPS - LIGHT_REACH_LOW), with k of 16 bits, rounded up; the last is infinite."""

GUIDE_PLACES, GUIDE_CELLS, GUIDE_STEPS = 32, 16, 1 << 16
"""Places around a caster along each side of their square, cells along each side of the square about the disk that it
shows, and steps of their shares (viewer/trace/scene/caustic_guide.py)."""

FLAG_SEE_THROUGH, FLAG_MIRRORED, FLAG_DOUBLE_SIDED, FLAG_UNLIT, FLAG_THIN, FLAG_PANE = 1, 2, 4, 8, 16, 32
"""Bits of an instance's flags."""

MAP_TEXELS = 3
"""Texels of a texture map's record in the scene buffer.

One has the page in the atlas (x | y << 16, width | height << 16) and the flags; two have the rows of the matrix that
transforms texture coordinates.
"""
WRAP_REPEAT, WRAP_CLAMP, WRAP_MIRROR = range(3)
WRAPS = {"repeat": WRAP_REPEAT, "clamp": WRAP_CLAMP, "mirror": WRAP_MIRROR}
MAP_WRAP_BITS = 2
"""The lowest bits of a map's flags are the wrap mode along s, the next ones that along t."""
MAP_NEAREST, MAP_SECOND_UV, MAP_TRANSFORMED = 1 << 4, 1 << 5, 1 << 6
MAP_ROLE_SHIFT = 8
"""The bits of a map's flags from here on are its roles (viewer/material/pack.py)."""


def medium_layout(switches: Mapping[str, int]) -> dict[str, int]:
    """The texels of a medium's record in the scene buffer: one is of scattering, and the last one of nested solids."""
    return {"MEDIUM_TEXELS": 1 + switches.get("HAS_SCATTERING", 0) + switches.get("HAS_NESTED", 0)}


def vertex_layout(switches: Mapping[str, int]) -> dict[str, int]:
    """Where in a vertex's texels its attributes are, and how many texels it has.

    The first texel has position and u, the second has normal and v. A tangent, second texture coordinates and a colour
    follow, each only if the switches say that it is used.
    """
    has_tangent, has_uv1, has_color = (switches.get(name, 0) for name in ("HAS_TANGENT", "HAS_UV1", "HAS_COLOR"))
    return {"VERTEX_TANGENT": 2, "VERTEX_UV1": 2 + has_tangent, "VERTEX_COLOR": 2 + has_tangent + has_uv1,
            "VERTEX_TEXELS": 2 + has_tangent + has_uv1 + has_color}
