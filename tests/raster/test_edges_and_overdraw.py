"""Counts of fragments, and the lines of a wireframe."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from images import image_of
from shapes import WHITE, moved, orthographic, plate, scene, sphere

from viewer.plan.legend import overdraw_colors
from viewer.plan.planner import plan_scene
from viewer.raster.renderer import Renderer
from viewer.raster.wireframe import COLOR, edges_of
from viewer.scene.environment import Environment
from viewer.scene.material import Material, Texture
from viewer.settings import Settings

SIZE = (40, 40)
SKY = Environment("grey", np.ones((16, 32, 3), np.float32))
UNLIT = Material(unlit=True)


def counts(renderer: Renderer, model, camera=None) -> np.ndarray:
    """(H, W): the number whose colour a pixel has, 0 where it is transparent."""
    codes = renderer.render(model, camera or orthographic(), Settings(show="overdraw"), SIZE).srgb
    colors = overdraw_colors()
    assert len({tuple(color) for color in colors.tolist()}) == 8
    found = (codes[..., None, :3] == colors).all(-1)
    assert (found.any(-1) == (codes[..., 3] > 0)).all()
    return np.where(found.any(-1), found.argmax(-1) + 1, 0)


@pytest.mark.parametrize(("depths", "expected"), [((0.3, 0.2, 0.1), 1), ((0.1, 0.2, 0.3), 3), ((0.1, 0.3, 0.2), 2)])
def test_opaque_surfaces_count_where_they_are_drawn_over_others(renderer, depths, expected):
    """In the order of their materials."""
    plates = [(plate(k, 0.5), moved((0, 0, z))) for k, z in enumerate(depths)]
    found = counts(renderer, scene(*plates, materials=(UNLIT,) * 3))
    assert found[20, 20] == expected and found[2, 2] == 0 and (found > 0).sum() == 20 * 20


def test_what_blends_counts_and_what_is_masked_does_not(renderer):
    veil = replace(UNLIT, base_color=(1, 1, 1, 0.1), alpha_mode="blend")
    mask = replace(UNLIT, base_color=(1, 1, 1, 0.1), alpha_mode="mask")
    model = scene((plate(0), np.eye(4)), (plate(1), moved((0, 0, 0.1))), (plate(1), moved((0, 0, 0.2))),
                  (plate(2), moved((0, 0, 0.3))), materials=(UNLIT, veil, mask))
    assert counts(renderer, model)[20, 20] == 3


def test_masks_that_are_maps_count_where_they_cover(renderer):
    """The left half of the map. The right one drops its fragments, and the plate behind it is seen."""
    left = np.full((8, 8, 4), 255, np.uint8)
    left[:, 4:, 3] = 0
    mask = replace(UNLIT, base_color_texture=Texture(image_of(left)), alpha_mode="mask")
    model = scene((plate(0), np.eye(4)), (plate(1), moved((0, 0, 0.1))), materials=(UNLIT, mask))
    found = counts(renderer, model)
    assert set(found[:, 1:17].ravel()) == {2} and set(found[:, 23:39].ravel()) == {1}


def test_more_than_eight_have_the_last_colour(renderer):
    veil = replace(UNLIT, base_color=(1, 1, 1, 0.1), alpha_mode="blend")
    model = scene(*((plate(0), moved((0, 0, 0.01 * k))) for k in range(11)), materials=(veil,))
    assert counts(renderer, model)[20, 20] == 8


def test_the_page_has_the_colours():
    text = (Path(__file__).parents[2] / "docs" / "views.md").read_text(encoding="utf-8")
    assert re.findall("#([0-9a-f]{6})", text) == [bytes(color).hex() for color in overdraw_colors()]


def test_each_edge_is_there_once():
    assert edges_of(np.array([[0, 1, 2], [2, 1, 3]])).tolist() == [[0, 1], [0, 2], [1, 2], [1, 3], [2, 3]]


def ink(renderer: Renderer, model, size=SIZE, camera=None, **settings: object) -> np.ndarray:
    """(H, W): how much of the white behind the lines is hidden, in units of a line's opacity."""
    chosen = Settings.of(**{"antialias": "none"} | settings)
    camera = camera or orthographic()
    plain, lined = (renderer.render(model, camera, replace(chosen, show=show), size).linear[..., 0].astype(float)
                    for show in ("shaded", "wireframe"))
    return (plain - lined) / np.where(plain > 0, plain, 1.0) / COLOR[3]


@pytest.mark.parametrize("antialias", ["none", "msaa-4", "ssaa-4"])
@pytest.mark.parametrize("shift", [0.0, 0.013])
def test_lines_are_a_pixel_wide_wherever_they_lie(renderer, shift, antialias):
    """The border of a plate before a larger one. Rows cross two edges and the diagonal."""
    model = scene((plate(0, 0.6), moved((shift, shift / 2, 0.5))), (plate(0, 3.0), np.eye(4)), materials=(UNLIT,))
    found = ink(renderer, model, antialias=antialias)
    upper = found[12:18]
    assert np.abs(upper[:, :14].sum(axis=1) - 1).max() < 0.15  # the left edge
    assert np.abs(upper[:, 30:].sum(axis=1) - 1).max() < 0.15  # the right one, at the silhouette
    assert abs(found[16:24, 14:26].sum() / 8 - np.sqrt(2)) < 0.2  # the diagonal, across which a row goes aslant
    assert found.max() < 1 / COLOR[3] and found.min() > -1e-3


def test_edges_behind_surfaces_are_hidden(renderer):
    model = scene((plate(0, 0.9), np.eye(4)), (plate(0, 0.5), moved((0, 0, -0.3))), materials=(UNLIT,))
    without = scene((plate(0, 0.9), np.eye(4)), materials=(UNLIT,))
    assert np.array_equal(ink(renderer, model), ink(renderer, without))


def test_dense_meshes_keep_their_shading(renderer):
    coarse = ink(renderer, scene(sphere(segments=8), materials=(UNLIT,)))
    dense = ink(renderer, scene(sphere(segments=160), materials=(UNLIT,)))
    assert coarse.max() > 0.8 and dense[10:30, 10:30].mean() < 0.75


def test_a_wireframe_is_planned_beside_the_shading_and_not_without():
    model = scene(plate(), materials=(WHITE,), environment=SKY)

    def planned(show):
        return plan_scene(model, Settings(show=show), (), samples=1, half_target=True, orthographic=False)

    shaded, lined = planned("shaded"), planned("wireframe")
    assert lined.programs == shaded.programs and lined.environment
    assert lined.to_json()["passes"] == [*shaded.to_json()["passes"][:-1], "wireframe", "display"]
    assert planned("overdraw").to_json()["passes"] == ["overdraw", "display"] and not planned("overdraw").environment
