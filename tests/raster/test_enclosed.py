"""The light inside of what thin walls enclose, where it can be worked out on paper."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from planning import MAP
from shapes import constant, moved, orthographic, plate, scene, sphere

from viewer.plan.planner import plan_scene
from viewer.raster.enclosed import light_inside
from viewer.scene.camera import Camera
from viewer.scene.material import Material
from viewer.scene.mesh import Mesh
from viewer.settings import Settings

CLEAR = Material(metallic=0.0, transmission=1.0, double_sided=True)
COLOR = np.array([0.9, 0.5, 0.1])


def half_sphere() -> Mesh:
    ball = sphere()
    corners = ball.positions[ball.indices].reshape(-1, 3, 3)
    return replace(ball, indices=ball.indices.reshape(-1, 3)[corners[..., 1].mean(axis=1) < 0].ravel())


def inside(material: Material, mesh: Mesh, mean=None) -> np.ndarray:
    plan = plan_scene(scene(mesh, materials=[material]), Settings(), (), samples=1, half_target=False,
                      orthographic=False)
    return light_inside(plan.draws[0], mesh, mean)


@pytest.mark.parametrize("mesh, opening", [(plate(), 1.0), (half_sphere(), 0.5), (sphere(), 0.0)])
def test_the_opening_of_a_surface(mesh, opening):
    """Of half a ball it is half: pi r^2 over walls of 2 pi r^2."""
    assert mesh.opening == pytest.approx(opening, abs=2e-3)
    assert replace(mesh, indices=mesh.indices[::-1]).opening == 1.0


@pytest.mark.parametrize("topology", ["points", "lines"])
def test_points_and_lines_enclose_nothing(topology):
    ball = sphere()
    assert replace(ball, topology=topology, indices=ball.indices[:4]).opening == 1.0


def test_a_clear_wall_hides_no_light_and_a_tinted_one_only_that_of_other_colours():
    assert inside(CLEAR, sphere()) == pytest.approx(np.ones(3))
    assert inside(replace(CLEAR, base_color=(*COLOR, 1)), sphere()) == pytest.approx(COLOR)


def test_what_arrives_through_an_opening_is_reflected_inside():
    grey = replace(CLEAR, transmission=0.0, specular=0.0, base_color=(0.5, 0.5, 0.5, 1))
    assert inside(grey, sphere()) == pytest.approx(np.zeros(3))
    assert inside(grey, half_sphere()) == pytest.approx(np.full(3, 0.5 / (1 - 0.5 * 0.5)), abs=2e-3)
    assert inside(grey, plate()) == pytest.approx(np.ones(3))


def test_a_wall_that_mirrors_scatters_and_transmits():
    """Half a ball of glass that is a little metallic, with maps: of the light that meets a face from all around
    2 R / (1 + R) is reflected, with Fresnel's R for the index 1.5."""
    mu = (np.arange(4000) + 0.5) / 4000
    refracted = np.sqrt(1 - (1 - mu**2) / 1.5**2)
    s, p = (mu - 1.5 * refracted) / (mu + 1.5 * refracted), (1.5 * mu - refracted) / (1.5 * mu + refracted)
    single = 0.8 * (s**2 + p**2) / 2
    mirrored = (2 * mu * 2 * single / (1 + single)).mean()
    uvs = (half_sphere().positions[:, :2],)
    wall = replace(CLEAR, metallic=0.5, transmission=0.9, specular=0.8, base_color=(*COLOR, 1),
                   metallic_roughness_texture=MAP, transmission_texture=MAP)
    metal, clear = 0.5 * 0.4, 0.9 * 0.7  # blue of one map, red of the other
    passed = (1 - metal) * (1 - mirrored) * clear * COLOR
    returned = metal * COLOR + (1 - metal) * (mirrored + (1 - mirrored) * (1 - clear) * COLOR)
    found = inside(wall, replace(half_sphere(), uvs=uvs), lambda draw, name: np.float64([0.7, 0.9, 0.4, 1.0]))
    assert found == pytest.approx((0.5 + 0.5 * passed) / (1 - 0.5 * returned), rel=3e-3)


def test_holes_of_a_mask_are_openings():
    """A quarter of the wall stands, and is black."""
    mask = replace(CLEAR, transmission=0.0, specular=0.0, base_color=(0.0, 0.0, 0.0, 1), alpha_mode="mask",
                   base_color_texture=MAP)
    mesh = replace(sphere(), uvs=(sphere().positions[:, :2],))
    assert inside(mask, mesh, lambda draw, name: np.float64([1, 1, 1, 0.25])) == pytest.approx(np.full(3, 0.75))


def test_the_far_wall_of_a_hollow_ball_has_the_light_inside(renderer):
    """Half of a wall without interfaces transmits its colour c, half scatters c: inside is E = c/2 / (1 - c/2)."""
    wall = replace(CLEAR, transmission=0.5, specular=0.0, base_color=(*COLOR, 1))
    model = scene((sphere(), moved((0, 0, 0))), materials=[wall], environment=constant())
    picture = renderer.render(model, orthographic(height=0.5), Settings.of(antialias="none"), (32, 32)).linear
    half = COLOR / 2
    far = half * half / (1 - half) + half
    assert picture[15:17, 15:17, :3].mean(axis=(0, 1)) == pytest.approx(half + half * far, abs=5e-3)


def test_the_inner_side_of_a_black_ball_mirrors_nothing(renderer):
    """Its wall lets no light in that it could mirror."""
    wall = replace(CLEAR, transmission=0.5, base_color=(0.0, 0.0, 0.0, 1), perceptual_roughness=0.5)
    model = scene((sphere(), moved((0, 0, 0))), materials=[wall], environment=constant())
    within = Camera.look_at((0, 0, 0), (0, 0, -1), fov_y=1.0)
    assert renderer.render(model, within, Settings.of(antialias="none"), (32, 32)).linear[..., :3].max() < 1e-3


def test_it_is_worked_out_once_for_a_mesh_and_anew_for_its_next_pose(renderer, monkeypatch):
    worked_out = []

    def counted(draw, mesh, mean):
        worked_out.append(mesh)
        return light_inside(draw, mesh, mean)

    monkeypatch.setattr("viewer.raster.material_uniforms.light_inside", counted)
    wall = replace(CLEAR, transmission=0.5, specular=0.0, base_color=(*COLOR, 1))
    closed = sphere(segments=24)
    opened = replace(closed, positions=closed.positions * np.where(closed.positions[:, 1:2] > 0, [1, 0, 1], 1))
    model = scene((closed, moved((0, 0, 0))), materials=[wall], environment=constant())
    settings = Settings.of(antialias="none")
    pictures = [renderer.render(shown, orthographic(), settings, (32, 32)).linear
                for shown in (model, model, replace(model, meshes=(opened,)))]
    assert worked_out == [closed, opened]
    assert np.array_equal(pictures[0], pictures[1]) and not np.array_equal(pictures[1], pictures[2])
