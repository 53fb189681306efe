"""Views of values: each shows exactly the numbers that docs/views.md says, in any light."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from shapes import WHITE, moved, orthographic, plate, scene, seen_plane, sphere

import viewer
from viewer.errors import UsageError
from viewer.plan.legend import VIEW_NAMES, legend
from viewer.plan.planner import environment_use, plan_scene
from viewer.raster.renderer import Renderer
from viewer.scene.camera import Camera
from viewer.scene.color import linear_to_srgb
from viewer.scene.curves import Curves
from viewer.scene.depth_span import depth_span
from viewer.scene.environment import Environment
from viewer.scene.light import Light
from viewer.scene.material import Material
from viewer.scene.mesh import Mesh
from viewer.settings import VALUES, Settings

SIZE = (24, 24)
SUN = Light.from_angles(0.3, 0.5, 3.0)
SKY = Environment("grey", np.ones((16, 32, 3), np.float32))
TURNED = np.array([[0.8, 0.0, 0.6], [0.36, 0.8, -0.48], [-0.48, 0.6, 0.64]])
"""A rotation; the third column is where the plate's +Z goes."""


def turned(scale: float = 1.0) -> np.ndarray:
    matrix = np.eye(4)
    matrix[:3, :3] = scale * TURNED
    return matrix


@pytest.fixture
def codes(renderer: Renderer):
    """`codes(scene, show, camera)`: the displayed RGBA codes of a view, (H, W, 4) as numbers."""

    def draw(model, show: str, camera: Camera | None = None, **settings: object) -> np.ndarray:
        chosen = Settings.of(**{"show": show, "antialias": "none"} | settings)
        return renderer.render(model, camera or orthographic(), chosen, SIZE).srgb.astype(float)

    yield draw
    assert renderer.context.gl.error == "GL_NO_ERROR"


def test_every_view_has_a_name():
    assert tuple(VIEW_NAMES)[1:-1] == VALUES


@pytest.mark.parametrize("display", [{}, {"exposure": 3.0, "tonemap": "aces"}], ids=["plain", "bright"])
def test_values_of_the_material_are_codes_that_no_light_or_tone_map_changes(codes, display):
    material = Material(base_color=(0.02, 0.5, 0.8, 1.0), metallic=0.6, perceptual_roughness=0.4)
    model = scene(plate(), materials=(material,), lights=(SUN,), environment=SKY)
    middle = {show: codes(model, show, **display)[12, 12] for show in VALUES}
    assert np.array_equal(middle["base-color"][:3], np.round(255 * linear_to_srgb(np.array([0.02, 0.5, 0.8]))))
    assert set(middle["roughness"][:3]) == {102.0} and set(middle["metalness"][:3]) == {153.0}
    assert all(code[3] == 255 for code in middle.values())


def test_normals_are_those_of_the_shading_and_those_of_the_triangles(codes):
    bent = np.array([0.48, 0.64, 0.6], np.float32)  # in the plate's own axes
    model = scene((replace(plate(), normals=np.tile(bent, (4, 1))), turned(2.0)))
    shading, flat = codes(model, "normal")[12, 12, :3], codes(model, "geometric-normal")[12, 12, :3]
    assert np.array_equal(shading, np.round(255 * (TURNED @ bent + 1) / 2))
    assert np.array_equal(flat, np.round(255 * (TURNED[:, 2] + 1) / 2))


def test_normals_are_on_the_eyes_side(codes):
    two_sided = scene((plate(), turned(2.0)), materials=(replace(WHITE, double_sided=True),))
    behind = codes(two_sided, "normal", orthographic(azimuth=np.pi))[12, 12, :3]
    assert np.array_equal(behind, np.round(255 * (1 - TURNED[:, 2]) / 2))
    assert np.array_equal(behind, codes(two_sided, "geometric-normal", orthographic(azimuth=np.pi))[12, 12, :3])


@pytest.mark.parametrize("camera", [orthographic(0.3, 0.2), Camera.orbit((0, 0, 0), 4.0, 0.3, 0.2)],
                         ids=["orthographic", "perspective"])
def test_depth_goes_from_white_to_black_between_the_numbers_that_are_told(codes, camera):
    model = scene((plate(), moved((0, 0, 0), 3.0)), sphere())
    near, far = depth_span(model, camera)
    assert f"white at {near:.4g} m, black at {far:.4g} m" in legend(model, camera, Settings(show="depth"))[0]
    seen = codes(scene((plate(), moved((0, 0, 0), 3.0)), (sphere(), moved((0, 0, -0.9), 0.1))), "depth", camera)
    if camera.height is not None:
        depth = (seen_plane(camera, SIZE) - camera.eye) @ camera.forward
    else:
        rows, columns = np.meshgrid(*(((np.arange(24) + 0.5) / 12 - 1) * np.tan(camera.fov_y / 2),) * 2, indexing="ij")
        rays = columns[..., None] * camera.pose[:3, 0] - rows[..., None] * camera.pose[:3, 1] + camera.forward
        depth = -(camera.eye[2] / rays[..., 2])
    near, far = depth_span(scene((plate(), moved((0, 0, 0), 3.0)), (sphere(), moved((0, 0, -0.9), 0.1))), camera)
    assert np.abs(seen[..., 0] - 255 * (1 - (depth - near) / (far - near))).max() <= 0.55
    assert np.ptp(seen[..., 0]) > 30


def test_texture_coordinates_are_red_and_green_over_a_checker(codes):
    seen = codes(scene(plate()), "uv")
    across = (np.arange(24) + 0.5) / 24
    assert np.abs(seen[..., 0] - 255 * across).max() <= 0.55
    assert np.abs(seen[..., 1] - 255 * across[:, None]).max() <= 0.55  # v grows downwards
    square = np.arange(24) // 3
    assert np.array_equal(seen[..., 2] > 0, (square + square[:, None]) % 2 == 1)
    assert np.array_equal(codes(scene(sphere()), "uv")[12, 12, :3].round(-1), [130.0] * 3)  # it has none


@pytest.mark.parametrize(("alpha", "mode", "is_there"), [
    (0.6, "blend", True), (0.4, "blend", False), (0.4, "opaque", True), (0.4, "mask", False)])
def test_one_surface_is_shown_in_a_pixel(codes, alpha, mode, is_there):
    veil = Material(base_color=(1, 0, 0, alpha), alpha_mode=mode, perceptual_roughness=0.2)
    behind = Material(perceptual_roughness=0.8)
    model = scene((plate(0), moved((0, 0, 0.5))), (plate(1), np.eye(4)), materials=(veil, behind))
    assert codes(model, "roughness")[12, 12, 0] == (51 if is_there else 204)


def test_curves_have_the_normals_of_tubes_and_the_depth_of_their_axis(codes):
    rod = Curves("rod", np.float32([[0, -2, 0], [0, 2, 0]]), np.float32([0.5, 0.5]), np.array([0, 2]),
                 np.array([False]))
    model = replace(scene(), curves=(rod,))
    seen = codes(model, "normal")
    x = ((np.arange(24) + 0.5) / 12 - 1)[7:17] / 0.5
    expected = 127.5 * (np.stack([x, 0 * x, np.sqrt(1 - x**2)], -1) + 1)
    assert np.abs(seen[12, 7:17, :3] - expected).max() <= 2
    assert seen[12, 2, 3] == 0 and seen[12, 12, 3] == 255
    assert all(codes(model, show)[12, 12, 3] == 255 for show in VALUES)


def test_views_have_nothing_of_light_and_shaded_pictures_nothing_of_views():
    model = scene(plate(), materials=(Material(),), lights=(SUN,), environment=SKY)

    def planned(**settings):
        return plan_scene(model, Settings.of(**settings), (SUN,), samples=4, half_target=True, orthographic=False)

    for show in VALUES:
        plan = planned(show=show, environment_shadows="64", reflections="traced", indirect="baked", fog=1.0)
        assert [program.fragment for program in plan.programs] == ["raster/view.frag"]
        assert not (plan.lights or plan.shadow_layer_count or plan.environment or plan.dfg or plan.background
                    or plan.media or plan.has_visibility or plan.has_indirect or plan.draws[0].maps)
        assert environment_use(model, Settings(show=show)) == (False, False)
    assert "SHOW" not in dict(planned().programs[0].switches)


def test_a_view_says_what_it_means_and_is_of_the_raster_alone():
    model = viewer.Scene("one", (plate(),), (WHITE,), scene(plate()).instances)
    image = viewer.render(model, (8, 8), show="roughness")
    assert image.stats["legend"] == ["Roughness: black 0, white 1"]
    with pytest.raises(UsageError, match="show has no effect in mode path, only in modes pbr and phong"):
        viewer.render(model, (8, 8), show="roughness", mode="path")
    with pytest.raises(UsageError, match="shaded pictures"):
        viewer.render(model, (8, 8), show="roughness", tell_error=1.0)
    with pytest.raises(UsageError, match="leave out the time budget"):
        viewer.render(model, (8, 8), show="roughness", time_budget=1.0)


def test_points_and_lines_without_normals_show_that_they_have_none(codes):
    line = Mesh("line", np.float32([[-1, 0, 0], [1, 0, 0], [-1, 0.02, 0], [1, 0.02, 0]]), 0, "lines")
    for show in ("normal", "geometric-normal", "roughness", "metalness"):
        seen = codes(scene(line), show)
        drawn = seen[seen[..., 3] == 255][:, :3]
        assert len(drawn) and set(drawn.ravel()) <= {127.0, 128.0}
