"""shaders/light/bspline.glsl against the sum over sixteen texels in float64."""

from __future__ import annotations

import moderngl
import numpy as np
import pytest
from contexts import is_software
from splines import bspline


@pytest.mark.parametrize("size", [(7, 5), (64, 32)])
def test_it_is_the_cubic_b_spline_through_the_texels(gl, evaluate, size):
    """Across the seam in u and over the border in v, too; 1e4 among small values leaves no rim below them."""
    random = np.random.default_rng(5)
    texels = random.random((size[1], size[0], 3)).astype(np.float32)
    texels[2, 3] = 1e4
    uv = random.random((500, 4))
    uv[:4, :2] = [(0.0, 0.0), (1.0, 1.0), (1e-3, 0.5), (0.999, 0.5)]
    texture = gl.texture(size, 3, texels, dtype="f4")
    texture.filter, texture.repeat_y = (moderngl.LINEAR, moderngl.LINEAR), False
    found = evaluate("light/bspline", "vec4(bspline(map, i.xy), 0.0)", uv, "uniform sampler2D map;", map=texture)[:, :3]
    expected = bspline(texels, uv[:, :2].astype(np.float32).astype(np.float64))
    bound, among_small = (1e-5, 1e-3) if is_software() else (2**-9, 1e4 * 2**-13)  # float32, or a texture unit's 8 bits
    assert np.abs(found - expected).max() < bound * 1e4 and found.min() >= 0
    small = expected.max(axis=1) < 1
    assert small.sum() > 100 and np.abs(found - expected)[small].max() < among_small
