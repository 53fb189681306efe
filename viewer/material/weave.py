"""A weave as the uniforms of shaders/bsdf/weave/weave.glsl. A picture has one, so that no material needs a record."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from ..scene.weave import MAX_SIDE, Weave

PLACES = 32
"""WEAVE_PLACES of shaders/raster/shade_woven.glsl."""


def weave_uniforms(weave: Weave | None) -> Iterator[tuple[str, object]]:
    """Names and values; none without a weave."""
    if weave is None:
        return
    rows = [sum(above << k for k, above in enumerate(row)) for row in weave.draft]
    yarns = [(*yarn.color, yarn.through, *yarn.specular, yarn.thickness, yarn.roughness, math.radians(yarn.twist),
              math.radians(yarn.bend), yarn.width) for yarn in (weave.warp, weave.weft)]
    yield "u_weave_size", (len(weave.draft[0]), len(rows))
    yield "u_weave_density", weave.density
    yield "u_weave_draft", np.array(rows + [0] * (MAX_SIDE - len(rows)), np.int32).tobytes()
    yield "u_weave_yarns", np.array(yarns, np.float32).tobytes()
    yield "u_weave_places", _places(weave).astype(np.float32).tobytes()


def _places(weave: Weave) -> np.ndarray:
    """Places of the draft that stand for all of it, (PLACES, 3): x and y in cells, and a weight with the mean 1.

    Half of them are on either system, and weigh together what its share of the cells is. They lie at the points of a
    Hammersley set, in cells that are evenly spaced among its own, in the order of their places along their arcs.
    """
    above = np.array(weave.draft)
    half = PLACES // 2
    k = np.arange(half)
    mirrored = np.array([int(f"{i:04b}"[::-1], 2) for i in k])
    places = []
    for is_warp in (True, False):
        y, x = np.nonzero(above == is_warp)
        order = np.argsort([_along(above == is_warp, j, i, axis=0 if is_warp else 1)
                            for j, i in zip(y.tolist(), x.tolist())], kind="stable")
        y, x = y[order], x[order]
        cell = (7 * k % half) * len(x) // half  # in another order than the points have
        weight = np.full(half, 2 * len(x) / above.size)
        places.append(np.column_stack([x[cell] + (k + 0.5) / half, y[cell] + (mirrored + 0.5) / half, weight]))
    return np.stack(places, axis=1).reshape(PLACES, 3)  # in turn, warp and weft


def _along(above: np.ndarray, y: int, x: int, axis: int) -> float:
    """The place of a cell's middle along the arc of its yarn, from 0 to 1. The draft repeats."""
    line = np.roll(above[:, x] if axis == 0 else above[y], -(y if axis == 0 else x))
    after = int(np.argmin(line))  # the first cell in which the yarn lies below
    before = int(np.argmin(line[::-1]))
    return (before + 0.5) / (before + after)
