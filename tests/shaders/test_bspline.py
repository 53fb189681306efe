"""shaders/light/bspline.glsl against the sum over sixteen texels in float64, and the buffer that it reads."""

from __future__ import annotations

import numpy as np
import pytest
from splines import bspline

from viewer.gpu.smooth_map import SmoothMap, texel_pairs

DECLARED = "uniform MAP_BUFFER map; uniform vec3 map_shape;"


@pytest.mark.parametrize("size", [(7, 5), (64, 32)])
@pytest.mark.parametrize("is_exact", [False, True])
def test_it_is_the_cubic_b_spline_through_the_texels(egl, evaluate, size, is_exact):
    """Across the seam in u and over the border in v, too; 1e4 among small values leaves no rim below them."""
    random = np.random.default_rng(5)
    texels = random.random((size[1], size[0], 3)).astype(np.float32)
    if not is_exact:
        texels = texels.astype(np.float16)  # which the map holds as they are
    texels[2, 3] = 1e4
    uv = random.random((500, 4))
    uv[:4, :2] = [(0.0, 0.0), (1.0, 1.0), (1e-3, 0.5), (0.999, 0.5)]
    smooth = SmoothMap(egl, texels, is_exact)
    found = evaluate("light/bspline", "vec4(bspline(map, map_shape, i.xy), 0.0)", uv, DECLARED,
                     {"EXACT_TEXELS": int(is_exact)}, map=smooth)[:, :3]
    expected = bspline(texels.astype(np.float64), uv[:, :2].astype(np.float32).astype(np.float64))
    assert np.abs(found - expected).max() < 1e-5 * 1e4 and found.min() >= 0
    small = expected.max(axis=1) < 1
    assert small.sum() > 100 and np.abs(found - expected)[small].max() < 1e-3


@pytest.mark.parametrize("peak", [1e12, 3.0, 1e-6, np.nextafter(np.float32(4), np.float32(0))])
def test_pairs_hold_the_texels(peak):
    """Over 2^60, to eleven bits, whatever the largest is, which may be rounded up to a power of two; what is smaller
    becomes 0."""
    random = np.random.default_rng(6)
    texels = (peak * 2.0 ** -random.uniform(0, 60, (5, 6, 3))).astype(np.float32)
    texels[1, 2], texels[3, 3], texels[4, 4] = peak, peak * 2.0**-80, -0.0
    pairs, unit = texel_pairs(texels)
    left, right = ((half.astype(np.uint32) << 13).view(np.float32) * np.float64(unit)
                   for half in (pairs & 0xFFFF, pairs >> 16))
    inside = left[2:-2, 2:-1, :3]
    is_large = texels > peak * 2.0**-61
    assert (np.abs(inside - texels) <= 2.0**-11 * texels)[is_large].all() and (inside[~is_large] == 0).all()
    rows, columns = np.arange(-2, 7).clip(0, 4), np.arange(-2, 7) % 6
    assert np.array_equal(left[..., :3], inside[rows[:, None], columns])
    assert np.array_equal(right[..., :3], inside[rows[:, None], (columns + 1) % 6])
