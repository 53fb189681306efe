"""The kinds of surfaces that the path tracer shades, each by a program of its own; fibres are one of them."""

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


SURFACE = Kind("surface", 0, "trace/surface.frag", lambda material: True)
GLASS = Kind("glass", 1, "trace/glass.frag", lambda material: material.transmits)
TRANSLUCENT = Kind("translucent", 2, "trace/translucent.frag", lambda material: material.transmits_diffusely)
BOUNDARY = Kind("boundary", 3, "trace/boundary.frag", lambda material: material.is_boundary)
"""Between media of one index, where scattering shows: nothing but the medium changes, so that light samples pass it."""
FIBRE = Kind("fibre", 4, "trace/fibre.frag", lambda material: False)
"""Curves, which have no material: a scene with any has this kind."""
WOVEN = Kind("woven", 5, "trace/woven.frag", lambda material: material.material.weave is not None)
KINDS = (WOVEN, BOUNDARY, GLASS, TRANSLUCENT, SURFACE, FIBRE)
"""All kinds. A material is of the first one whose `when` holds."""


def kind_of(material: TraceMaterial) -> Kind:
    """The kind that shades `material`."""
    return next(kind for kind in KINDS if kind.when(material))
