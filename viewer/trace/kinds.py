"""The kinds of surfaces that the path tracer shades, each by a program of its own, and the classes of paths."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .scene.materials import TraceMaterial


@dataclass(frozen=True)
class Kind:
    """One kind of surface.

    `name` is that of its pass, `number` (0 to 6) stands in hits, `file` is its fragment shader, and `when` says which
    materials are of this kind. GLSL has the number as `KIND_<NAME>`.
    """

    name: str
    number: int
    file: str
    when: Callable[[TraceMaterial], bool]


SURFACE = Kind("surface", 0, "trace/surface.frag", lambda material: material.transmission == 0)
GLASS = Kind("glass", 1, "trace/glass.frag", lambda material: material.transmission > 0)
KINDS = (SURFACE, GLASS)
"""All kinds. A material is of the kind whose `when` holds."""

NO_KIND = 7
"""The number in the hit of a ray that missed."""

CLASS_IDLE, CLASS_ENDED, CLASS_FIRST_HIT, CLASS_SHADE = range(4)
"""The classes of paths. Each pass shades the paths of one class.

A path is idle; or it has ended; or its camera ray has hit a surface, for the pass that collects layers; or it has hit a
surface of kind k, which is class CLASS_SHADE + k.
"""


def kind_of(material: TraceMaterial) -> Kind:
    """The kind that shades `material`."""
    return next(kind for kind in KINDS if kind.when(material))
