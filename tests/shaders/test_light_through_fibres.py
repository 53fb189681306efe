"""Light that fibres let through to others: how much comes, and how they have spread it."""

from __future__ import annotations

import math

import numpy as np
import pytest
from fibre_twin import longitudinal, variances

from viewer.bake.fibre import ABSORPTIONS, COSINES, HALF_ABSORPTION, fibre_table

DEFINES = {"HAIR_LIGHT": 1, "LIGHT_COUNT": 1, "HAS_ENVIRONMENT": 0, "NEAR": 1}
BETA_M, BETA_N, TILT, IOR = 0.25, 0.35, 0.04, 1.55
J, K = 12, (2, 5, 9)  # texels of the table
X = np.array(K) / (ABSORPTIONS - 1)
SIGMA_A = HALF_ABSORPTION * X / (1 - X)
THETA_O = -math.acos(J / (COSINES - 1))


@pytest.mark.parametrize("depth", [0.01, 0.7, 6.0])
def test_the_share_of_light_and_how_many_fibres_it_has_crossed(gl, evaluate, depth):
    """Against the sum over all numbers of fibres on its way, which are Poisson distributed."""
    kept = np.array([0.2, 0.5, 0.9])
    depths = gl.texture3d((1, 1, 1), 1, np.float32([depth]).tobytes(), dtype="f4")
    found = evaluate("raster/curve_light", "vec4(light_through_fibres(0, i.xyz).share, "
                     "light_through_fibres(0, i.xyz).crossed)", np.zeros((1, 4)), defines=DEFINES,
                     u_hair_depths=depths, u_hair_kept=kept)[0]
    n = np.arange(1, 60)
    met = depth**n * math.exp(-depth) / np.array([math.gamma(k + 1) for k in n])
    through = met * (1 - kept[:, None])**n
    np.testing.assert_allclose(found[:3], through.sum(axis=1) / met.sum(), rtol=1e-4)
    grey = met * (1 - kept.mean())**n
    np.testing.assert_allclose(found[3], grey @ n / grey.sum(), rtol=1e-4)


@pytest.mark.parametrize("crossed", [0.0, 1.0, 6.5])
def test_fibres_turn_light_along_them_and_spread_it(gl, evaluate, crossed):
    """The response over all angles about the fibre, against M: each fibre that light has gone through adds the variance
    of TT and the tilt of its scales. The spread about the fibre loses nothing."""
    table = fibre_table(BETA_N, IOR)
    texture = gl.texture3d(table.shape[2::-1], 4, np.ascontiguousarray(table).tobytes(), dtype="f4")
    texture.repeat_x = texture.repeat_y = texture.repeat_z = False
    theta, phi = np.linspace(-1.4, 1.4, 15), (np.arange(64) + 0.5) * 2 * np.pi / 64
    grids = np.meshgrid(theta, phi, crossed, 0.0, indexing="ij")
    inputs = np.stack([grid.ravel() for grid in grids], axis=1)
    fibre = f"Fibre(vec3({', '.join(f'{a:.7f}' for a in SIGMA_A)}), {BETA_M}, {BETA_N}, {TILT}, {IOR})"
    wo = f"vec3({math.sin(THETA_O):.7f}, 0.0, {math.cos(THETA_O):.7f})"
    wi = "vec3(sin(i.x), cos(i.x) * sin(i.y), cos(i.x) * cos(i.y))"
    response = f"vec4(response_through_fibres(seen_fibre({fibre}, {wo}, 0.0, 0.0), {wi}, i.z), 1.0)"
    found = evaluate("raster/curve_light", response, inputs, defines=DEFINES, u_fibre_table=texture,
                     u_hair_spread=np.array([0.44]))[:, :3].reshape(15, 64, 3).sum(axis=1) * 2 * np.pi / 64
    v = variances(BETA_M) + crossed * variances(BETA_M)[1]
    expected = np.zeros((15, 3))
    for p, turn in enumerate((-2, 1, 4, 0)):
        turned = theta + crossed * TILT  # beyond a right angle on the other side
        turned = np.arctan2(np.sin(turned), np.abs(np.cos(turned)))
        M = longitudinal(turned, -(THETA_O + turn * TILT), v[p])
        expected += M[:, None] * table[K, J, :, p].mean(axis=1) * 2 * np.pi
    np.testing.assert_allclose(found, expected, rtol=0.02, atol=1e-4)
