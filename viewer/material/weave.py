"""A weave as the uniforms and the table of shaders/bsdf/weave/weave.glsl. A picture has one, so no material needs a
record."""

from __future__ import annotations

import math
from collections.abc import Iterator

import moderngl
import numpy as np

from ..bake.entered import colors_left, scattered_again
from ..bake.yarn import MEAN, max_rise, weave_table
from ..gpu.float_texture import float_texture
from ..gpu.programs import set_uniform
from ..scene.weave import MAX_SIDE, Weave

PLACES = 32
"""WEAVE_PLACES of shaders/raster/shade_woven.glsl."""


class WeaveBinding:
    """The weave of the last picture on the GPU."""

    def __init__(self, gl: moderngl.Context) -> None:
        self._gl = gl
        self._held: tuple[Weave, moderngl.Texture] | None = None

    def bind(self, program: moderngl.Program, weave: Weave | None, unit: int) -> None:
        """Set the uniforms of a program, and bind the table to a texture unit; nothing without a weave."""
        if weave is None:
            return
        if self._held is None or self._held[0] != weave:
            self.release()
            self._held = weave, float_texture(self._gl, weave_table(weave))
        self._held[1].use(unit)
        set_uniform(program, "u_weave_table", unit)
        for name, value in _uniforms(weave):
            set_uniform(program, name, value)

    def use(self, unit: int) -> None:
        """Bind the table of the last picture to a texture unit again."""
        if self._held is not None:
            self._held[1].use(unit)

    def release(self) -> None:
        if self._held is not None:
            self._held[1].release()
            self._held = None


def _uniforms(weave: Weave) -> Iterator[tuple[str, object]]:
    yarns = []
    for yarn in (weave.warp, weave.weft):
        passed, returned = colors_left(yarn.color)
        specular = (share / MEAN for share in yarn.specular)
        yarns.append((*scattered_again(yarn.color), yarn.through, *specular, yarn.thickness, yarn.roughness,
                      math.tan(math.radians(yarn.seen_twist)), math.radians(yarn.bend), yarn.width, *passed,
                      max_rise(yarn), *returned, 0.0))
    yield "u_weave_size", (len(weave.draft[0]), len(weave.draft))
    yield "u_weave_density", weave.density
    yield "u_weave_flatness", weave.flatness
    yield "u_weave_cells", _cells(weave).tobytes()
    yield "u_weave_yarns", np.array(yarns, np.float32).tobytes()
    yield "u_weave_places", _places(weave).astype(np.float32).tobytes()


def _cells(weave: Weave) -> np.ndarray:
    """The cells of the draft, row by row, (MAX_SIDE^2,) int32.

    Bit 0: whether the warp lies above. From bits 1 and 5 on: how many cells before and after it along the weft have the
    same yarn above; from bits 9 and 13 on, along the warp.
    """
    above = np.array(weave.draft)
    cells = np.zeros(MAX_SIDE**2, np.int32)
    for k, (y, x) in enumerate(np.ndindex(*above.shape)):
        is_same = above == above[y, x]
        (left, right), (down, up) = _run(is_same[y], x), _run(is_same[:, x], y)
        cells[k] = above[y, x] | left << 1 | right << 5 | down << 9 | up << 13
    return cells


def _run(line: np.ndarray, place: int) -> tuple[int, int]:
    """How many elements before and after a true one are true without a break. The line repeats."""
    line = np.roll(line, -place)
    return int(np.argmin(line[::-1])), int(np.argmin(line)) - 1


def _places(weave: Weave) -> np.ndarray:
    """Places of the draft that stand for all of it, (PLACES, 3): x and y in cells, and a weight with the mean 1.

    Half of them are on either system, and weigh together what its share of the cells is. They lie at the points of a
    Hammersley set, in cells that are evenly spaced among its own, in the order of their places along their arcs. The
    set has points in two corners, where gaps are: of a weave that has any, it is moved by a quarter along one side.
    """
    above = np.array(weave.draft)
    half = PLACES // 2
    k = np.arange(half)
    mirrored = np.array([int(f"{i:04b}"[::-1], 2) for i in k])
    if weave.has_gaps:
        mirrored = (mirrored + half // 4) % half
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
    before, after = _run(above[:, x], y) if axis == 0 else _run(above[y], x)
    return (before + 0.5) / (before + 1 + after)
