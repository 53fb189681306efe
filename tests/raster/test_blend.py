"""What is see-through, and in which order it is drawn."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from images import image_of
from shapes import moved, orthographic, plate, scene, sphere

import viewer
from viewer.base.resources import resource_folder
from viewer.scene.material import Material, Texture

RED, BLUE = (0.8, 0.1, 0.1), (0.1, 0.2, 0.9)


def pane(color, alpha: float) -> Material:
    return Material(base_color=(*color, alpha), unlit=True, alpha_mode="blend", double_sided=True)


@pytest.mark.parametrize("order", [(0, 1, 2, 3, 4, 5, 6), (6, 5, 4, 3, 2, 1, 0), (3, 1, 5, 0, 6, 2, 4)])
def test_picture_does_not_depend_on_the_order_of_nodes(radiance, order):
    alpha = viewer.load(resource_folder("assets") / "scenes" / "alpha.glb", environment=None)
    alpha = replace(alpha, lights=(viewer.Light.from_angles(0.3, 0.8, 3.0),))
    assert len(alpha.instances) == len(order)
    shuffled = replace(alpha, instances=tuple(alpha.instances[k] for k in order))
    a, b = (radiance(each, alpha.cameras[0], (64, 64), background="none") for each in (alpha, shuffled))
    assert np.array_equal(a, b)
    assert 0.2 < (a[..., 3] > 0).mean() < 0.9


@pytest.mark.parametrize("order", [(0, 1, 2, 3, 4, 5, 6), (6, 5, 4, 3, 2, 1, 0), (3, 1, 5, 0, 6, 2, 4)])
def test_nor_on_the_order_of_meshes(radiance, order):
    """As where a file is written anew by a program that sorts otherwise."""
    alpha = viewer.load(resource_folder("assets") / "scenes" / "alpha.glb", environment=None)
    alpha = replace(alpha, lights=(viewer.Light.from_angles(0.3, 0.8, 3.0),))
    shuffled = replace(alpha, meshes=tuple(alpha.meshes[k] for k in order),
                       instances=tuple(replace(i, mesh=order.index(i.mesh)) for i in alpha.instances))
    a, b = (radiance(each, alpha.cameras[0], (64, 64), background="none") for each in (alpha, shuffled))
    assert np.array_equal(a, b)


@pytest.mark.parametrize("azimuth", [0.0, np.pi])
def test_the_farther_pane_lies_behind(radiance, azimuth):
    """Porter & Duff 1984: over, in linear light, with associated alpha."""
    panes = scene((plate(0), moved((0, 0, 0.5))), (plate(1), moved((0, 0, -0.5))),
                  materials=[pane(RED, 0.5), pane(BLUE, 0.25)])
    near, far = ((RED, 0.5), (BLUE, 0.25)) if azimuth == 0 else ((BLUE, 0.25), (RED, 0.5))
    expected = np.array([*np.array(near[0]) * near[1], near[1]])
    expected += (1 - near[1]) * np.array([*np.array(far[0]) * far[1], far[1]])
    picture = radiance(panes, orthographic(azimuth, height=1.0), (8, 8), background="none")
    assert np.abs(picture - expected).max() < 1e-6


def test_triangles_of_one_mesh_are_sorted_too(radiance):
    """The far side of a double-sided ball shows through its near side, whatever the eye's direction."""
    glass = replace(pane(RED, 0.4), base_color=(1, 1, 1, 0.4))
    for azimuth in (0.0, 2.0, 4.0):
        picture = radiance(scene(sphere(segments=24), materials=[glass]), orthographic(azimuth, 0.3, 1.0), (8, 8),
                           background="none")
        assert np.abs(picture[..., 3] - (1 - 0.6**2)).max() < 1e-5


def test_opaque_things_hide_what_blends_behind_them(radiance):
    wall = Material(base_color=(0.1, 0.6, 0.2, 0.3), unlit=True)  # opaque: its alpha does not matter
    model = scene((plate(0), moved((0, 0, -0.5))), (plate(1), moved((0, 0, 0.5))), materials=[pane(RED, 0.5), wall])
    picture = radiance(model, orthographic(height=1.0), (8, 8), background="none")
    assert np.abs(picture - [0.1, 0.6, 0.2, 1.0]).max() < 1e-6


@pytest.mark.parametrize("mode, cutoff", [("blend", 0.5), ("mask", 0.125)])
def test_what_a_map_leaves_out_is_not_seen_from_far_away(radiance, mode, cutoff):
    """A map of white texels, one of four, between transparent black ones, as in maps of leaves and letters."""
    pixels = np.zeros((64, 64, 4), np.uint8)
    pixels[::2, ::2] = 255
    cut = Material(base_color_texture=Texture(image_of(pixels)), unlit=True, alpha_mode=mode, alpha_cutoff=cutoff)
    picture = radiance(scene(plate(), materials=[cut]), orthographic(height=1.0), (8, 8), background="none",
                       antialias="msaa-4")
    assert np.abs(picture[..., :3] - picture[..., 3:]).max() < 1e-3
    if mode == "blend":
        assert np.abs(picture[..., 3] - 64 / 255).max() < 1e-3
    else:  # the share of a cell with (1 - x) (1 - y) >= cutoff, as 4 x 4 points in a texel find it
        assert abs(picture[..., 3].mean() - (1 - cutoff * (1 - np.log(cutoff)))) < 1 / 16


def test_what_a_map_leaves_out_is_not_seen_near_its_edges(radiance):
    """The colours between the texels of a map that the picture enlarges, some of which hide black."""
    pixels = np.zeros((4, 4, 4), np.uint8)
    pixels[1:3, 1:3] = 255
    cut = Material(base_color_texture=Texture(image_of(pixels)), unlit=True, alpha_mode="blend")
    picture = radiance(scene(plate(), materials=[cut]), orthographic(height=2.0), (32, 32), background="none")
    assert np.abs(picture[..., :3] - picture[..., 3:]).max() < 1e-3
    assert (np.abs(picture[..., 3] - 0.5) < 0.2).any()


def test_background_none_is_transparent_and_covers_by_share(radiance):
    model = scene(sphere(), materials=[Material(unlit=True, base_color=(*BLUE, 1.0))])
    picture = radiance(model, orthographic(height=3.0), (64, 64), background="none", antialias="msaa-4")
    alpha = picture[..., 3]
    assert (alpha[0] == 0).all() and alpha[32, 32] == 1
    assert set(np.unique(alpha)) == {0, 0.25, 0.5, 0.75, 1}
    assert np.abs(picture[..., :3] - alpha[..., None] * BLUE).max() < 1e-6
    assert alpha.mean() == pytest.approx(np.pi / 9, rel=0.01)
