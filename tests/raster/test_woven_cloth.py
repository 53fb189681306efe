"""Woven cloth in both renderers: no light is created or lost, near or far; both agree; far cloth does not flicker."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
from shapes import WHITE as PLAIN
from shapes import constant, facing_floor, lopsided, moved, orthographic, plate, scene

from viewer.material.weave import _cells
from viewer.scene.light import Light
from viewer.scene.material import Material
from viewer.scene.weave import WEAVES, Weave
from viewer.settings import Settings

SIZE = (16, 16)
SUN = Light("directional", intensity=2.0, direction=(-0.5, -0.3, -0.8))


@pytest.fixture
def weave(tmp_path):
    def write(yarn, draft=("110", "011", "101"), density=30.0, **warp) -> str:
        file = tmp_path / "own.json"
        file.write_text(json.dumps({"draft": list(draft), "density": [density, density], "warp": {**yarn, **warp},
                                    "weft": yarn}))
        return str(file)

    return write


WHITE = {"color": [1, 1, 1], "specular": [0.3, 0.3, 0.3], "width": 0.9, "thickness": 3}


@pytest.fixture
def pictures(radiance, tracer):
    """By the raster and by paths."""
    def draw(model, camera, spp, **settings):
        path = tracer.render(model, camera, Settings.of(mode="path", spp=spp, **settings), SIZE)
        return radiance(model, camera, SIZE, **settings)[..., :3], path.linear[..., :3]

    return draw


@pytest.mark.parametrize("height", [0.05, 1.2])
def test_white_cloth_vanishes_in_a_furnace(pictures, weave, height):
    """Near, where a yarn fills the picture, and far: yarns, fibres and gaps keep all light."""
    raster, path = pictures(scene(plate(), environment=constant()), orthographic(0.5, 0.6, height), 48,
                            weave=weave(WHITE))
    assert np.abs(raster.mean() - 1) < 5e-3 and np.abs(raster - 1).max() < 0.05
    assert np.abs(path.mean() - 1) < 6e-3


@pytest.mark.parametrize(("name", "height", "error"), [("denim", 0.12, 0.05), ("satin", 1.2, 0.12)])
def test_the_raster_shows_what_paths_show(pictures, name, height, error):
    """In the mean of each channel. The raster mirrors a blurred environment, of which satin shows most."""
    model = scene(plate(), environment=lopsided(), lights=(SUN,))
    raster, path = pictures(model, orthographic(0.5, 0.6, height), 24, weave=name)
    assert np.abs(raster.mean(axis=(0, 1)) / path.mean(axis=(0, 1)) - 1).max() < error
    if height < 1:  # where yarns are seen, the same ones
        assert np.corrcoef(raster[..., 1].ravel(), path[..., 1].ravel())[0, 1] > 0.9


def test_far_cloth_neither_flickers_nor_changes_its_brightness(radiance, weave):
    """As the camera moves by parts of a yarn, which is far below a pixel; and when it comes so near that it sees nine
    yarns, which are three drafts."""
    yarn = {"color": [0.7, 0.7, 0.7], "bend": 50, "width": 1}
    model = scene(plate(), lights=(SUN,))
    far = weave(yarn, density=800.0, color=[0.05, 0.05, 0.05])
    found = np.array([radiance(model, orthographic(1e-3 * k, 0, 1.0), SIZE, weave=far)[..., 0] for k in range(3)])
    assert np.ptp(found) < 2e-3 * found.mean()
    near = weave(yarn, density=18.0, color=[0.05, 0.05, 0.05])
    mean = radiance(model, orthographic(0, 0, 1.0), (96, 96), weave=near)[..., 0].mean()
    assert mean == pytest.approx(found.mean(), rel=0.05)


def test_the_points_of_a_pixel_share_the_places_of_a_far_draft(radiance, weave):
    """So that supersampling shows the very mean that one point with all places does."""
    model = scene(plate(), lights=(SUN,))
    far = weave({"color": [0.7, 0.7, 0.7], "bend": 50, "width": 1}, density=800.0, color=[0.05, 0.05, 0.05])
    one, shared = (radiance(model, orthographic(0.5, 0.6, 1.0), SIZE, weave=far, antialias=antialias)[..., 0]
                   for antialias in ("none", "ssaa-4"))
    assert np.abs(shared / one - 1).max() < 2e-3


def test_cloth_with_gaps_lies_in_the_shade_as_cloth_without_does(radiance, weave):
    """Above a black floor that hides a part of the sky. What shows in wide gaps is in the shade of the cloth."""
    materials = Material(metallic=0.0, name="cloth"), replace(PLAIN, base_color=(0, 0, 0, 1)), PLAIN
    floor, wall = (plate(1), facing_floor(2.0, -0.5)), (plate(2), moved((0, 0, -0.05)))

    def shown(width, *others):
        name = weave({**WHITE, "color": [0.5, 0.5, 0.5], "width": width}, density=800.0)
        model = scene(plate(), *others, materials=materials, environment=constant())
        return radiance(model, orthographic(0.3, 0.4, 0.6), SIZE, weave=f"{name},cloth", environment_shadows="64",
                        background="none").mean(axis=(0, 1))

    assert shown(1.0, floor)[1] < 0.85 * shown(1.0)[1]
    assert shown(0.99, floor)[1] == pytest.approx(shown(1.0, floor)[1], rel=0.02)
    net = shown(0.5)
    assert shown(0.5, wall)[1] < net[1] + 0.3 * (1 - net[3])


@pytest.mark.parametrize("width", [0.5, 0.9])
def test_cloth_that_shows_in_the_gaps_of_cloth_is_as_bright_as_alone(radiance, weave, width):
    """Though fewer places stand for it where gaps are narrow: two, one behind the other, are what one over the other
    makes. Both cover what yarns of their width do."""
    net = weave({"color": [0.7, 0.7, 0.7], "width": width}, density=800.0, color=[0.05, 0.05, 0.05])
    one, two = (radiance(scene(*plates, lights=(SUN,)), orthographic(0, 0, 1.0), SIZE, weave=net, shadows="off")
                for plates in ((plate(),), (plate(), (plate(), moved((0, 0, -0.3))))))
    assert np.abs(1 - one[..., 3] - (1 - width)**2).max() < 0.02
    np.testing.assert_allclose(two, one + (1 - one[..., 3:]) * one, rtol=0.01)


def test_fibres_shine_in_the_plane_across_them(radiance, weave):
    """Seen along the normal, under a light that is moved across the yarns above, and along them."""
    yarn = {"color": [0, 0, 0], "specular": [0.5, 0.5, 0.5], "roughness": 0.1, "bend": 0, "twist": 0, "width": 1}
    weft_above = ["".join("1" if (5 * k + 3) % 16 == j else "0" for j in range(16)) for k in range(16)]
    warp_above = [row.translate(str.maketrans("01", "10")) for row in weft_above]

    def seen(draft, azimuth, elevation):
        model = scene(plate(), lights=(Light.from_angles(azimuth, elevation, 3.0),))
        return radiance(model, orthographic(0, 0, 1.0), (8, 8), weave=weave(yarn, draft, density=800.0))[..., 0].mean()

    # Weft runs along x, warp along y
    assert seen(weft_above, 0.0, 0.7) > 4 * seen(weft_above, 0.7, 0.0)
    assert seen(warp_above, 0.7, 0.0) > 4 * seen(warp_above, 0.0, 0.7)


@pytest.mark.parametrize("draft", [("110", "011", "101"), ("01111", "11011", "11110", "10111", "11101")])
def test_the_draft_repeats_at_negative_texture_coordinates(pictures, weave, draft):
    """Moved by 40 drafts of three yarns, by 24 of five, in texture coordinates: in the raster and by paths."""
    moved = replace(plate(), uvs=(plate().uvs[0] - np.float32([4, 4]),))
    name = weave({"width": 0.9}, draft)
    here, there = (pictures(scene(mesh, lights=(SUN,)), orthographic(0.3, 0.4, 0.3), 1, weave=name, background="none")
                   for mesh in (plate(), moved))
    for a, b in zip(here, there):
        assert a.std() > 0.05 * a.mean()
        assert np.median(np.abs(a - b)) < 1e-3 * a.mean() and np.abs(a - b).mean() < 0.01 * a.mean()


def test_cells_know_how_far_their_yarns_lie_above():
    """Against counting, step by step, around each cell of a draft that is not square."""
    draft = np.array([[c == "1" for c in row] for row in ("11010", "01101", "10110")])
    cells = _cells(Weave(tuple(map(tuple, draft.tolist()))))
    height, width = draft.shape

    def run(y, x, dy, dx):
        count = 0
        while draft[(y + (count + 1) * dy) % height, (x + (count + 1) * dx) % width] == draft[y, x]:
            count += 1
        return count

    for y, x in np.ndindex(height, width):
        steps = run(y, x, 0, -1), run(y, x, 0, 1), run(y, x, -1, 0), run(y, x, 1, 0)
        assert cells[y * width + x] == draft[y, x] + sum(n << 1 + 4 * k for k, n in enumerate(steps))


def test_cloth_needs_no_interface_to_mirror_light(radiance):
    """Its fibres do, also where a material that is woven has no specular reflection of its own."""
    cloth = Material(metallic=0.0, specular=0.0, weave=WEAVES["twill"])
    assert cloth.reflects
    found, plain = (radiance(scene(plate(), materials=[material], environment=constant()), orthographic(), SIZE)
                    for material in (cloth, replace(cloth, specular=1.0)))
    np.testing.assert_array_equal(found, plain)


@pytest.mark.parametrize("yarn", [{"thickness": 0, "width": 0.05}, {"roughness": 0.02, "bend": 60, "twist": 60},
                                  {"roughness": 1, "through": 1, "thickness": 1e4, "width": 1}])
def test_extremes_are_finite(pictures, weave, yarn):
    lights = SUN, Light("point", intensity=2.0, position=(0, 0, 0.5))
    model = scene(plate(), environment=lopsided(), lights=lights)
    for camera, density in ((orthographic(1.56, 0.01, 1.0), 1e6), (orthographic(3.0, 0.3, 1e-3), 5.0)):
        for picture in pictures(model, camera, 1, weave=weave(yarn, density=density), background="none"):
            assert np.isfinite(picture).all() and picture.min() >= 0
