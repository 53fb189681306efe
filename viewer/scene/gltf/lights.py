"""KHR_lights_punctual: lights, which the nodes that refer to them place."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ..light import KINDS, RANGES, Light
from ..rig import light_direction
from .element import Element


class Lights:
    """The lights that the file defines."""

    def __init__(self, root: Element) -> None:
        extension = root.extension("KHR_lights_punctual")
        self._items = [] if extension is None else extension.array("lights")

    def number(self, node: Element) -> int | None:
        """The number of a node's light, or None."""
        extension = node.extension("KHR_lights_punctual") if "extensions" in node else None
        return None if extension is None else extension.index("light", len(self._items), None)

    def at_node(self, number: int, node: Element, world: np.ndarray) -> Light | None:
        """A light of the file at a node, with the node's world matrix applied; None, with a warning, for an unknown
        kind. Scale does not change intensity or range (KHR_lights_punctual)."""
        element = self._items[number]
        kind: Any = element.string("type")
        if kind not in KINDS:
            element.warn(f"{kind[:20]!r} is unknown; the light is left out", "type")
            return None
        range_ = element.number("range", None, 0.0)
        return Light(kind, element.vector("color", 3, (1.0, 1.0, 1.0), 0.0),
                     element.number("intensity", 1.0, *RANGES["intensity"]), tuple(world[:3, 3].tolist()),
                     light_direction(world), range_ or None, *_cone(element),
                     name=element.string("name", node.string("name", "")))


def _cone(element: Element) -> tuple[float, float]:
    """The inner and outer cone angle in radians; the extension requires 0 <= inner < outer <= pi / 2."""
    spot = element.object("spot")
    outer = spot.number("outerConeAngle", math.pi / 4, 1e-4, RANGES["outer_cone"][1])
    inner = spot.number("innerConeAngle", 0.0, *RANGES["inner_cone"])
    if inner >= outer:
        spot.warn(f"{inner:g} is not below the outer angle {outer:g}; the cone gets a sharp edge", "innerConeAngle")
        inner = outer * (1 - 1e-4)
    return inner, outer
