"""Patches of meshes that lamps and suns light, found in their shadow maps: what they reflect lights media."""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import contextmanager

import moderngl
import numpy as np

from ..gpu.programs import Programs
from ..plan.model import Program
from .computed import compute
from .shadows import ShadowMaps
from .units import UNIT_DEPTHS, UNIT_PATCHES

_PATCHES = 256
"""About so many for all lights together, but no less than four for a tile of the shadow maps."""


@contextmanager
def lit_patches(gl: moderngl.Context, programs: Programs, planned: Program, shadows: ShadowMaps,
                uniforms: dict[str, object]) -> Iterator[dict[str, object]]:
    """Adds to `uniforms`, those of media whose depths towards lights are bound, those of
    shaders/raster/media_off_meshes.frag. The texture of patches has the outputs of lit_patches.frag beside it, one in
    each row, where light reaches them; there is one patch at least. In the meantime shadow maps do not compare."""
    tiles = planned["SHADOW_LAYERS"]
    side = max(math.isqrt(_PATCHES // tiles), 2)
    texture = shadows.texture
    compared, filtered = texture.compare_func, texture.filter
    texture.compare_func, texture.filter = "", (moderngl.NEAREST, moderngl.NEAREST)
    texture.use(UNIT_DEPTHS)
    uniforms = uniforms | {"u_depths": UNIT_DEPTHS}
    try:
        rows = compute(gl, programs, planned, (side * side, tiles), 3, uniforms | {"u_side": side})
        patches = np.clip(np.nan_to_num(np.reshape(rows, (3, -1, 4))), -1e30, 1e30)
        is_lit = patches[2].any(axis=1)
        is_lit[0] |= not is_lit.any()
        lit = np.ascontiguousarray(patches[:, is_lit])
        found = gl.texture((lit.shape[1], 3), 4, lit, dtype="f4")
        found.use(UNIT_PATCHES)
        try:
            yield uniforms | {"u_patches": UNIT_PATCHES}
        finally:
            found.release()
    finally:
        texture.compare_func, texture.filter = compared, filtered
