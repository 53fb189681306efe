"""The kinds of surfaces that the path tracer shades, each by a program of its own, and the classes of paths."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .scene.materials import TraceMaterial


@dataclass(frozen=True)
class Kind:
    """One kind of surface: the name of its pass, its number in hits (0 to 6), its program, and which materials it has.

    GLSL knows the number as `KIND_<NAME>`.
    """

    name: str
    number: int
    file: str
    when: Callable[[TraceMaterial], bool]


SURFACE = Kind("surface", 0, "trace/surface.frag", lambda material: material.transmission == 0)
GLASS = Kind("glass", 1, "trace/glass.frag", lambda material: material.transmission > 0)
KINDS = (SURFACE, GLASS)
"""Every kind; a material is of the one whose `when` holds."""

NO_KIND = 7
"""The number in the hit of a ray that met nothing."""

REST, FINISH, FIRST_HIT, SHADE = range(4)
"""The classes of paths, by which passes choose theirs: idle; ended, so that the next one begins; at the first surface
that the camera sees; at a surface of kind k, which is class SHADE + k."""


def kind_of(material: TraceMaterial) -> Kind:
    """The kind that shades `material`."""
    return next(kind for kind in KINDS if kind.when(material))
