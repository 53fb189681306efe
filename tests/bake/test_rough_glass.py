"""The factors by which rough glass loses no light."""

from __future__ import annotations

import numpy as np
import pytest

from viewer.bake.dfg import dfg_albedos
from viewer.bake.rough_boundary import RoughBoundary
from viewer.bake.rough_glass import COSINES, LAYERS, ROUGHEST, ROUGHNESSES, rough_glass_factors, solve, with_rough_glass
from viewer.gpu.call import call_glsl

MU = np.linspace(0.15, 0.995, 20) ** 2


def factor(table: np.ndarray, cosine: np.ndarray, boundary: RoughBoundary, is_inside: bool) -> np.ndarray:
    f0 = ((boundary.ior - 1) / (boundary.ior + 1)) ** 2
    return np.exp(call_glsl("light/rough_glass.glsl", "rough_glass_factor", table=table, cosine=cosine,
                            alpha=boundary.alpha, f0=f0, is_inside=is_inside))


@pytest.mark.parametrize("roughness", [0.2, 0.35, 0.48])
def test_all_light_leaves_on_one_side_or_the_other(roughness):
    """By quadrature over the facets, as shaders read the table between its values."""
    table = with_rough_glass(dfg_albedos("ggx", "smith"), "smith")
    for ior in (1.33, 1.5, 2.4):
        boundary = RoughBoundary(ior, roughness**2)
        for is_inside, eta in ((False, ior), (True, 1 / ior)):
            (back, reflected), (onward, refracted) = boundary.scattered(MU, eta)
            shares = (reflected * factor(table, back, boundary, is_inside)
                      + refracted * factor(table, onward, boundary, not is_inside)).sum(axis=1)
            shares *= factor(table, MU, boundary, is_inside)
            assert np.abs(shares - 1).max() < 0.025
            assert abs(shares @ MU / MU.sum() - 1) < 0.01
            lost = 1 - (reflected + refracted).sum(axis=1)
            assert lost.max() > 0.15 * roughness


def test_the_table_in_the_package_is_what_is_computed():
    tiles = rough_glass_factors("smith").reshape(LAYERS // 4, COSINES, 4, ROUGHNESSES, 4).swapaxes(1, 2)
    layers = tiles.reshape(LAYERS, COSINES, ROUGHNESSES, 4)
    for layer, column in ((6, 8), (9, 15)):
        root, roughness = layer / (LAYERS - 1), ROUGHEST * column / (ROUGHNESSES - 1)
        found = solve(RoughBoundary((1 + root**2) / (1 - root**2), roughness**2))
        assert np.abs(layers[layer, :, column, :2] - found.T).max() < 0.01
        assert np.array_equal(layers[layer - 1, :, column, 2:], layers[layer, :, column, :2])
    assert (layers[:, :, 0] == 0).all()  # smooth
