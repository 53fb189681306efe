"""What surfaces mirror of the model itself: a wall behind a mirror, worked out on paper and by the path tracer."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from needs import needs
from shapes import WHITE, constant, facing_floor, lopsided, moved, orthographic, plate, scene, seen_plane, sphere

import viewer.raster.traced.reflected_surfaces as reflected_surfaces
import viewer.raster.traced.reflections as traced_reflections
from viewer.plan.planner import plan_scene
from viewer.raster.traced.reflections import TracedReflections
from viewer.scene.camera import Camera
from viewer.scene.environment import Environment
from viewer.scene.material import Material
from viewer.scene.scene import Scene
from viewer.settings import Settings
from viewer.trace.tracer import Tracer
from viewer.trace.vertex_light import bake_outgoing

SIZE = (48, 48)
MIRROR = Material(metallic=1.0, perceptual_roughness=0.0)
RED = replace(WHITE, base_color=(0.6, 0.2, 0.1, 1.0))
VIEW = orthographic(0.0, np.pi / 4, height=3.0)


@pytest.fixture(autouse=True)
def few_samples(monkeypatch):
    """A few vertices need no million paths."""
    monkeypatch.setattr(reflected_surfaces, "bake_outgoing", partial(bake_outgoing, samples=1 << 14))


def hall(wall: Material = RED, floor: Material = MIRROR, scale: float = 1.0, environment=None):
    """A mirror on the floor, and across it a wall from 0 to 1 in height and from -1 to 1 in x."""
    upright = moved((0, 0.5 * scale, 0), scale) @ moved((0, 0, 0), (1.0, 0.5, 1.0))
    return scene((plate(0, half=2.0), moved((0, 0, 0), scale) @ facing_floor()), (plate(1), upright),
                 materials=[floor, wall], environment=environment or constant())


HALL, LOPSIDED_HALL = hall(), hall(environment=lopsided())  # one object each, so that a renderer prepares them once


def path_traced(tracer: Tracer, hall_in: Scene, **settings: object) -> np.ndarray:
    exposure = tracer.begin(hall_in, VIEW, Settings.of(mode="path", spp=64, **settings), SIZE)
    while not exposure.is_done:
        exposure.step(0.25)
    pixels = exposure.image().linear
    exposure.release()
    return pixels


def in_mirror(margin: float = 0.12):
    """Which pixels mirror the wall, and which nothing, as far as `margin` from its outline."""
    points = seen_plane(VIEW, SIZE, (0, 1, 0))
    x, z = points[..., 0], points[..., 2]
    on_floor = (np.abs(x) < 2 - margin) & (np.abs(z) < 2 - margin)
    # A mirrored ray rises as fast as it nears the wall.
    met = on_floor & (np.abs(x) < 1 - margin) & (z > margin) & (z < 1 - margin)
    missed = on_floor & (z > margin) & ((np.abs(x) > 1 + margin) | (z > 1 + margin))
    assert met.sum() > 50 and missed.sum() > 50
    return met, missed


def test_a_mirror_shows_the_wall(radiance):
    # The wall sees only radiance 1, by itself or in the mirror, so it sends its base colour. But to the bake the mirror
    # is white and matte, and darker where the wall shades it.
    picture = radiance(HALL, VIEW, SIZE, reflections="traced")[..., :3]
    met, missed = in_mirror()
    assert np.abs(picture[met] - RED.base_color[:3]).max() < 0.05
    assert np.abs(picture[missed] - 1).max() < 0.01


@pytest.mark.parametrize("shadows, bound", [("off", 1e-6), ("16", 2e-3)])  # multiple scattering is shaded
def test_what_misses_is_the_environment_exactly(radiance, shadows, bound):
    _, missed = in_mirror()
    pictures = [radiance(LOPSIDED_HALL, VIEW, SIZE, **settings)[missed]
                for settings in ({}, {"reflections": "traced", "environment_shadows": shadows})]
    assert np.abs(pictures[1] / pictures[0] - 1).max() < bound


@pytest.mark.parametrize("scale", [1e-6, 1e6])
def test_the_scale_does_not_matter(radiance, scale):
    view = orthographic(0.0, np.pi / 4, height=3.0 * scale, distance=5.0 * scale)
    unit = radiance(HALL, VIEW, SIZE, reflections="traced")
    assert np.abs(radiance(hall(scale=scale), view, SIZE, reflections="traced") - unit).max() < 2e-3


@pytest.mark.parametrize("roughness, bound", [(0.0, 0.16), (0.3, 0.18)])
def test_it_is_near_the_path_tracer(context, radiance, roughness, bound):
    # What the floor sends to the wall is baked as if that were matte, which is most of the difference.
    hall_in = hall(floor=replace(MIRROR, perceptual_roughness=roughness), environment=lopsided())
    tracer = Tracer(context)
    truth = path_traced(tracer, hall_in)
    tracer.release()
    met, errors = in_mirror()[0], []
    for reflections in ("environment", "traced"):
        picture = radiance(hall_in, VIEW, SIZE, reflections=reflections, environment_shadows="16")
        errors.append(float(np.abs((picture / truth)[met, :3] - 1).mean()))
    assert errors[1] < bound < 0.5 * errors[0]


def test_a_rough_floor_loses_as_much_light_to_a_black_wall_as_by_paths(context, radiance):
    # Rays that graze the floor meet the wall most often. Where all weigh alike, 0.07 of the light is missing.
    black = replace(RED, base_color=(0.0, 0.0, 0.0, 1.0))
    hall_in = hall(black, replace(MIRROR, perceptual_roughness=0.75))
    tracer = Tracer(context)
    truth = path_traced(tracer, hall_in, multiscatter="off")
    tracer.release()
    picture = radiance(hall_in, VIEW, SIZE, reflections="traced", multiscatter="off")
    met = in_mirror()[0]
    assert abs(picture[met, 1].mean() / truth[met, 1].mean() - 1) < 0.03


def test_rays_of_a_kept_picture_cover_a_lobe_with_few_steps(radiance, monkeypatch):
    """One ray from each point shows the wall 16 times in a rough floor, once for each direction."""
    rough = hall(floor=replace(MIRROR, perceptual_roughness=0.4), environment=lopsided())
    pictures = []
    for rays in (1, traced_reflections.RAYS, 64):
        monkeypatch.setattr(traced_reflections, "RAYS", rays)
        pictures.append(radiance(rough, VIEW, SIZE, reflections="traced")[..., :3])
    few, kept = (np.abs(picture - pictures[2]).mean() for picture in pictures[:2])
    assert 0 < kept < 0.4 * few


@pytest.mark.parametrize("antialias", ["msaa-4", "deferred-4"])
def test_samples_at_an_edge_do_not_take_rays_from_the_other_side_of_it(radiance, antialias):
    """All is dark: a black plate that reflects 0.04, beyond its edge a mirror seen at a grazing angle, and a backdrop
    that it mirrors. The plate's rays see the environment: where they stood for the mirror's, the edge would be 0.3."""
    black = Material(base_color=(0.0, 0.0, 0.0, 1.0), metallic=0.0, perceptual_roughness=0.5)
    edge = 0.01  # a quarter of a pixel to the right of the middle one's centre
    away = np.array([[0, 0, 1, edge], [0, 1, 0, 0], [-1, 0, 0, -1], [0, 0, 0, 1.0]])
    ridge = scene((plate(0), moved((edge - 1, 0, 0))), (plate(1), away), (plate(0, half=1.5), moved((1, 0, -2.5))),
                  materials=[black, MIRROR], environment=constant())
    picture = radiance(ridge, orthographic(0.08, 0.0, height=1.0), (25, 24), reflections="traced", background="none",
                       antialias=antialias)
    assert 0.03 < picture[..., :3].max() < 0.05


def test_a_frame_of_a_moving_camera_has_one_ray_a_point(renderer, monkeypatch):
    counts, begin = [], traced_reflections._Rays.begin
    monkeypatch.setattr(traced_reflections._Rays, "begin", lambda rays, programs, frame, number, count: (
        counts.append((number, count)), begin(rays, programs, frame, number, count)))
    for still in (False, True):
        renderer.draw(HALL, VIEW, Settings.of(reflections="traced"), SIZE, still=still)
    rays = traced_reflections.RAYS
    assert counts == [(0, 1), *((number, rays) for number in range(rays))]


@needs("embree")
def test_bvh_and_embree_agree(context, renderer, radiance, monkeypatch):
    pictures = []
    for kind in ("embree", "bvh"):
        reflections = TracedReflections(context, renderer.programs, kind)
        monkeypatch.setattr(renderer._passes, "reflections", reflections)
        pictures.append(radiance(LOPSIDED_HALL, VIEW, SIZE, reflections="traced"))
        reflections.release()
    assert (np.abs(pictures[0] - pictures[1]).max(axis=-1) > 1e-4).mean() < 0.002  # rays at edges


def test_a_mirror_shows_no_back_of_a_single_side(radiance):
    behind = orthographic(np.pi, np.pi / 4, height=3.0)
    met = in_mirror()[0]
    sides = [radiance(hall(replace(RED, double_sided=both)), behind, SIZE, reflections="traced")[met, :3]
             for both in (False, True)]
    assert np.abs(sides[0]).max() < 1e-4
    assert np.abs(sides[1] - RED.base_color[:3]).max() < 0.05


def test_what_blends_is_not_shown(radiance):
    wall = replace(RED, alpha_mode="blend", base_color=(0.6, 0.2, 0.1, 0.5))
    picture = radiance(hall(wall), VIEW, SIZE, reflections="traced")
    assert np.abs(picture[in_mirror()[0], :3] - 1).max() < 0.01


def test_glass_is_shown_as_one_looks_at_it(radiance):
    # Its specular is 0: it reflects nothing.
    wall = replace(RED, transmission=1.0, perceptual_roughness=0.0, base_color=(0.5, 0.5, 0.5, 1.0))
    picture = radiance(hall(wall), VIEW, SIZE, reflections="traced")
    assert np.abs(picture[in_mirror()[0], :3] - 0.5).max() < 0.03


@pytest.mark.parametrize("roughness", [0.0, 0.2, 0.6])
def test_grazing_views_are_finite(radiance, roughness):
    balls = [(sphere(segments=24), moved((x, 0, 0))) for x in (-1.0, 1.0)]
    both = scene(*balls, materials=[replace(MIRROR, perceptual_roughness=roughness)], environment=lopsided())
    for elevation in (0.0, 1e-4):
        radiance(both, Camera.orbit((0, 0, 0), 4.0, np.pi / 2, elevation), SIZE, reflections="traced")


def test_two_mirrors_show_one_another_dark_where_the_environment_is(radiance):
    """A metal that is met sends what its own lobe sees: the dark floor's half, not the mean of all around."""
    rows = np.where(np.arange(32) < 16, 1.0, 1e-3).astype(np.float32)
    up = Environment("sky", np.tile(rows[:, None, None], (1, 64, 3)))
    picture = radiance(hall(MIRROR, environment=up), VIEW, SIZE, reflections="traced")
    # By floor and wall light leaves upwards, into what is bright.
    assert picture[in_mirror()[0], :3].mean() > 0.5


def test_everything_is_the_same_picture(radiance):
    pictures = [radiance(LOPSIDED_HALL, VIEW, SIZE, reflections="traced", plan=plan)
                for plan in ("needed", "everything")]
    assert (np.abs(pictures[1] - pictures[0]) / (np.abs(pictures[0]) + 1e-2)).max() < 2e-3


def test_the_plan_says_what_is_traced():
    settings = Settings.of(reflections="traced")
    smooth, rough, off = (
        plan_scene(scene_in, of, [], samples=1, half_target=True, orthographic=False)
        for scene_in, of in ((HALL, settings), (hall(floor=replace(MIRROR, perceptual_roughness=1.0)), settings),
                             (HALL, Settings())))
    assert [draw.traces_reflections for draw in smooth.draws] == [True, False]  # the wall has no interface
    assert any("rays from each shaded point" in line for line in smooth.used)
    assert "reflections" in smooth.to_json()["passes"]
    assert "traced reflections: no opaque surface is smooth and isotropic" in rough.left_out
    assert "traced reflections: not requested" in off.left_out
    assert not rough.has_traced_reflections and not off.has_traced_reflections


def test_the_directions_of_neighbouring_rays_leave_no_grid(radiance):
    """They repeat every 4 pixels. What repeats so in the picture is a grid: the mean of all pixels at one place of
    their blocks, less the mean of 4 x 4 pixels around each."""
    rough = hall(floor=Material(metallic=1.0, perceptual_roughness=0.5))
    grey = radiance(rough, VIEW, (96, 96), reflections="traced")[..., 1]
    points = seen_plane(VIEW, (96, 96), (0, 1, 0))
    rows = np.flatnonzero((points[:, 48, 2] > 0.2) & (points[:, 48, 2] < 1.2))
    grey = grey[rows[0]:rows[-1] + 1, 24:72]
    taps = np.array([0.5, 1, 1, 1, 0.5]) / 4
    smooth = np.apply_along_axis(np.convolve, 0, np.apply_along_axis(np.convolve, 1, grey, taps, "same"), taps, "same")
    detail = ((grey - smooth) / smooth)[4:-4, 4:-4]
    grid = np.array([[detail[y::4, x::4].mean() for x in range(4)] for y in range(4)])
    assert np.ptp(smooth[4:-4, 4:-4]) > 0.1 and np.abs(grid).max() < 0.02  # 0.06 where all taps of the filter are equal
