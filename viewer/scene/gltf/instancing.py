"""EXT_mesh_gpu_instancing: a node whose mesh is drawn many times, each time placed by attributes."""

from __future__ import annotations

import numpy as np

from ..animation import unit_quaternions
from ..rig import compose
from .accessors import Accessors
from .element import Element

EXTENSION = "EXT_mesh_gpu_instancing"
_ATTRIBUTES = {"TRANSLATION": ("VEC3", (0.0, 0.0, 0.0)), "ROTATION": ("VEC4", (0.0, 0.0, 0.0, 1.0)),
               "SCALE": ("VEC3", (1.0, 1.0, 1.0))}
_ELEMENTS = 64
"""An instance takes the memory of so many elements of an accessor."""


def instance_offsets(accessors: Accessors, node: Element) -> np.ndarray | None:
    """The matrices from instances to the node, (K, 4, 4) float64; None if the node has the mesh itself.

    Raises InputError for attributes that do not fit each other or are not finite.
    """
    place = node.extension(EXTENSION)
    if place is None:
        return None
    attributes = place.object("attributes")
    indices = {key: attributes.index(key, len(accessors.items)) for key in _ATTRIBUTES if key in attributes}
    if not indices:
        raise place.error("has neither TRANSLATION nor ROTATION nor SCALE", "attributes")
    counts = {key: accessors.count(index) for key, index in indices.items()}
    (first, count), *others = counts.items()
    for key, other in others:
        if other != count:
            raise attributes.error(f"{other} values for {count} of {first}", key)
    accessors.claim(place, _ELEMENTS * count, f"{count} more instances")
    values = {key: np.tile(default, (count, 1)) for key, (_, default) in _ATTRIBUTES.items()}
    for key, index in indices.items():
        values[key] = accessors.floats(index, _ATTRIBUTES[key][0]).astype(np.float64)
        if not np.isfinite(values[key]).all():
            raise attributes.error("the values must be finite", key)
    return compose(values["TRANSLATION"], unit_quaternions(values["ROTATION"]), values["SCALE"])
