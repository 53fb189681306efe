"""shaders/light/: the lookups of image-based light against what viewer/bake says they do."""

from __future__ import annotations

import moderngl
import numpy as np
import pytest

from viewer.bake.dfg import SIZE, dfg_table
from viewer.bake.prefilter import LEVEL_ROUGHNESS

COUNT = 1024


@pytest.fixture
def directions() -> np.ndarray:
    d = np.random.default_rng(7).normal(size=(COUNT, 4))
    d[:8, :3] = [(0, 1, 0), (0, -1, 0), (1, 0, 0), (-1, 0, 0), (-1, 0, -1e-7), (0, 0, 1), (0, 0, -1), (1e-5, 1, 0)]
    d[:, :3] /= np.linalg.norm(d[:, :3], axis=1, keepdims=True)
    d[:, 3] = np.linspace(0, 1, COUNT)
    return d


def test_equirect_uv(evaluate, directions):
    found = evaluate("light/equirect", "vec4(equirect_uv(i.xyz), 0.0, 0.0)", directions)
    u = 0.5 + np.arctan2(directions[:, 2], directions[:, 0]) / (2 * np.pi)
    v = np.arccos(directions[:, 1]) / np.pi
    assert np.isfinite(found).all()
    off = np.abs(found[:, 0] - u)[2:]  # at a pole any u will do
    assert np.minimum(off, 1 - off).max() < 1e-4 / (2 * np.pi)
    assert np.abs(found[:, 1] - v).max() < 5e-5 / np.pi


def test_lod_of_roughness(evaluate, directions):
    """Linear between the levels in alpha / (alpha + 0.4)."""
    found = evaluate("light/prefiltered", "vec4(lod_of_roughness(i.w))", directions)[:, 0]
    levels, asked = (r**2 / (r**2 + 0.4) for r in (np.array(LEVEL_ROUGHNESS), directions[:, 3]))
    assert np.abs(found - np.interp(asked, levels, np.arange(len(levels)))).max() < 1e-5
    assert found[0] == 0 and np.diff(found).min() > 0


def test_a_level_is_looked_up_where_its_direction_is(gl, evaluate, directions):
    # Levels that hold their own row's y = cos(theta), which a lookup must find again, the poles and seam included.
    texture = gl.texture((1024, 512), 3, dtype="f4")
    texture.build_mipmaps(max_level=5)
    for k in range(6):
        height = 512 >> k
        theta = np.pi * ((np.arange(height) + 0.5) / height - 1 / 32) / (15 / 16)
        phi = 2 * np.pi * ((np.arange(2 * height) + 0.5) / (2 * height) - 0.5)
        sine = np.sin(theta)[:, None]
        level = np.stack([sine * np.cos(phi), np.cos(theta)[:, None] + 0 * phi, sine * np.sin(phi)], axis=-1)
        texture.write(level.astype("f4").tobytes(), level=k)
    texture.filter = (moderngl.LINEAR_MIPMAP_LINEAR, moderngl.LINEAR)
    texture.repeat_x, texture.repeat_y = True, False
    look_up = "vec4(prefiltered_radiance(map, i.xyz, lod_of_roughness(i.w)), 0.0)"
    for level, roughness in enumerate(LEVEL_ROUGHNESS):
        directions[:, 3] = roughness
        found = evaluate("light/prefiltered", look_up, directions, "uniform sampler2D map;", map=texture)[:, :3]
        spacing = np.pi / (512 >> level) * 16 / 15
        assert np.abs(found - directions[:, :3]).max() < spacing**2 / 4 + 3e-3 * 2.0**-level + 3e-4


def test_irradiance_is_looked_up_along_the_normal(gl, evaluate, directions):
    # A map that is linear in the direction: bilinear lookup errs by its curvature alone.
    height = 32
    theta = np.pi * ((np.arange(height) + 0.5) / height - 1 / 32) / (15 / 16)
    phi = 2 * np.pi * ((np.arange(2 * height) + 0.5) / (2 * height) - 0.5)
    sine = np.sin(theta)[:, None]
    rows = np.stack([sine * np.cos(phi), np.cos(theta)[:, None] + 0 * phi, sine * np.sin(phi)], axis=-1)
    texture = gl.texture((2 * height, height), 3, rows.astype("f4").tobytes(), dtype="f4")
    texture.repeat_x, texture.repeat_y = True, False
    found = evaluate("light/irradiance", "vec4(irradiance_over_pi(map, i.xyz), 0.0)", directions,
                     "uniform sampler2D map;", map=texture)[:, :3]
    assert np.abs(found - directions[:, :3]).max() < (np.pi / 30) ** 2 / 4 + 3e-3


def test_dfg_lookup_hits_the_table(gl, evaluate):
    values = dfg_table()
    table = gl.texture((SIZE, 4 * SIZE), 4, values.tobytes(), dtype="f4")
    table.repeat_x = table.repeat_y = False
    column, row = np.random.default_rng(9).integers(0, SIZE, (2, COUNT))
    inputs = np.stack([(row / (SIZE - 1)) ** 2, column / (SIZE - 1), column, row], axis=1)

    def found(call):
        return evaluate("light/dfg", f"vec4({call})", inputs, "uniform sampler2D table;", table=table)

    assert np.abs(found("dfg_mean(table, i.y), 0.0, 0.0")[:, :2] - values[0, column, 2:]).max() < 1e-3
    # llvmpipe places samples to 1/256 of a texel, and the table is steep only towards the mirror at grazing view.
    assert np.abs(found("dfg_albedo(table, i.x, i.y), 0.0, 0.0")[:, :2] - values[row, column, :2]).max() < 5e-3
    for k in (1, 2, 3):
        lookup = found(f"lobe_lookup(table, i.x, i.y, {k})")
        assert np.abs(lookup - values[k * SIZE + row, column]).max() < 0.01
