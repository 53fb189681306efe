"""What of the environment is hidden, found by many lights: against form factors worked out on paper."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from shapes import WHITE, constant, facing_floor, lopsided, moved, orthographic, plate, scene, seen_plane, sphere

from viewer.bake.many_lights import many_lights
from viewer.bake.prefilter import level_integral, prefilter
from viewer.plan.planner import plan_scene
from viewer.raster.renderer import Renderer
from viewer.scene.camera import Camera
from viewer.scene.curves import Curves
from viewer.scene.environment import Environment
from viewer.scene.light import Light
from viewer.scene.material import Material
from viewer.scene.mesh import Mesh
from viewer.scene.scene import Instance, Scene
from viewer.settings import Settings

SIZE = (48, 48)
BLACK = replace(WHITE, base_color=(0, 0, 0, 1), double_sided=True)
VIEW = orthographic(0.0, np.pi / 2, height=3.0)


def corner(scale: float = 1.0, environment=None):
    """A white floor on both sides of a black wall of height 1 along X that is as good as endless."""
    return scene((plate(0, half=2.0), moved((0, 0, 0), scale) @ facing_floor()),
                 (plate(1), moved((0, 0.5 * scale, 0), scale) @ moved((0, 0, 0), (8.0, 0.5, 1.0))),
                 materials=[WHITE, BLACK], environment=environment or constant())


def expected_and_place():
    """The share of uniform light the floor sees, (1 + cos gamma) / 2 beside a wall that rises by gamma, and |z|."""
    z = np.abs(seen_plane(VIEW, SIZE, (0, 1, 0))[..., 2])
    return (1 + np.cos(np.arctan2(1.0, z))) / 2, z


def error(radiance, lights: str) -> float:
    expected, z = expected_and_place()
    found = radiance(corner(), VIEW, SIZE, environment_shadows=lights)[..., 0]
    return float(np.sqrt(np.mean((found - expected)[z > 0.15] ** 2)))


def test_a_wall_hides_what_its_form_factor_says(radiance):
    assert error(radiance, "256") < 0.018


def test_strands_side_by_side_hide_what_a_wall_does(radiance):
    count = 40
    y = np.repeat((np.arange(count) + 0.5) / count, 2)
    points = np.stack([np.tile([-8.0, 8.0], count), y, np.zeros(2 * count)], axis=1)
    fence = Curves("fence", points, np.full(2 * count, 0.5 / count), 2 * np.arange(count + 1), np.zeros(count, bool))
    floor = replace(scene((plate(0, half=2.0), facing_floor()), environment=constant()), curves=(fence,))
    beside = expected_and_place()[1] > 0.15
    found, wall = (radiance(model, VIEW, SIZE, environment_shadows="64")[..., 0] for model in (floor, corner()))
    assert np.sqrt(np.mean((found - wall)[beside]**2)) < 0.03 and wall[beside].min() < 0.75


def slab(thickness: float) -> Mesh:
    """An endless one, as good as, from y = 0 up."""
    top = np.float32([[-20, thickness, -20], [-20, thickness, 20], [20, thickness, 20], [20, thickness, -20]])
    return Mesh("slab", np.concatenate([top, top * np.float32([1, 0, 1])]), 1,
                indices=np.uint32([0, 1, 2, 0, 2, 3, 4, 6, 5, 4, 7, 6]),
                normals=np.float32([[0, 1, 0]] * 4 + [[0, -1, 0]] * 4))


@pytest.mark.parametrize("hand", [1, -1])
def test_a_slab_absorbs_what_it_does_on_its_way_straight_on(radiance, hand):
    """An index of 1 reflects nothing. 2 E_3(sigma d) of the light arrives, the integral of 2 mu exp(-sigma d / mu)."""
    body = Material(metallic=0.0, perceptual_roughness=0.0, transmission=1.0, ior=1.0, thickness=0.5,
                    attenuation_distance=0.5, attenuation_color=(0.8, 0.4, 0.1))
    model = scene((plate(0, half=2.0), facing_floor()), (slab(0.5), moved((0, 1, 0), (hand, 1, 1))),
                  materials=[WHITE, body], environment=constant())
    below = Camera.look_at((0, 0.5, 0), (0, 0, 1e-3))
    found = radiance(model, below, (8, 8), environment_shadows="64")[..., :3]
    mu = (np.arange(1000)[:, None] + 0.5) / 1000
    expected = (2 * mu * np.exp(np.log([0.8, 0.4, 0.1]) / mu)).mean(axis=0)
    assert np.abs(found - expected).max() < 0.006
    ink = replace(model, materials=(WHITE, replace(body, attenuation_distance=1e-6)))  # beyond half floats
    assert radiance(ink, below, (8, 8), environment_shadows="64")[..., :3].max() < 0.01
    wall = replace(body, thickness=0.0, base_color=(0.9, 0.5, 0.1, 1.0))
    pane = replace(model, meshes=(model.meshes[0], plate(1, half=20.0)), materials=(WHITE, wall),
                   instances=(model.instances[0], Instance(1, moved((0, 1, 0), (hand, 1, 1)) @ facing_floor())))
    assert np.abs(radiance(pane, below, (8, 8), environment_shadows="64")[..., :3] - [0.9, 0.5, 0.1]).max() < 0.01


def test_only_scenes_with_glass_have_tints():
    def tints_sky(model: Scene, lights: str) -> bool:
        settings = Settings(environment_shadows=lights)
        return plan_scene(model, settings, (), samples=1, half_target=True, orthographic=True).tints_sky

    glass = replace(corner(), materials=(WHITE, replace(WHITE, transmission=1.0)))
    assert [tints_sky(corner(), "16"), tints_sky(glass, "16"), tints_sky(glass, "off")] == [False, True, False]


def test_more_lights_are_nearer(radiance):
    errors = [error(radiance, lights) for lights in ("16", "64", "256")]
    assert errors[1] < 0.6 * errors[0] and errors[2] < 0.6 * errors[1]


def test_what_nothing_hides_is_as_without(radiance):
    ball = scene(sphere(segments=64), environment=lopsided())
    view = orthographic(0.3, 0.2, height=1.4)  # within the silhouette
    pictures = [radiance(ball, view, SIZE, environment_shadows=lights)[..., :3] for lights in ("off", "64")]
    assert np.abs(pictures[1] / pictures[0] - 1).max() < 0.05


@pytest.mark.parametrize("lean", [0.0, 0.5, 1.0])
def test_a_plane_hides_nothing_of_itself(radiance, lean):
    """Whichever way it leans, and with it what a texel of the maps spans of it."""
    turn = moved((0, 0, 0))
    turn[:2, :2] = [[np.cos(lean), -np.sin(lean)], [np.sin(lean), np.cos(lean)]]
    floor = scene((plate(0, half=2.0), turn @ facing_floor()), environment=lopsided())
    pictures = [radiance(floor, orthographic(0.7, 0.9, height=1.5), SIZE, environment_shadows=lights)[..., :3]
                for lights in ("off", "64")]
    assert np.abs(pictures[1] / pictures[0] - 1).max() < 1e-3


@pytest.mark.parametrize("scale", [1e-6, 1e6])
def test_the_scale_does_not_matter(radiance, scale):
    view = orthographic(0.4, 0.6, height=3.0 * scale, distance=5.0 * scale)
    unit = radiance(corner(), orthographic(0.4, 0.6, height=3.0), SIZE, environment_shadows="16")
    assert np.abs(radiance(corner(scale), view, SIZE, environment_shadows="16") - unit).max() < 2e-3


def test_turning_all_about_the_axis_changes_nothing(radiance):
    """The lights turn with the environment: one that is turned with its model gives the same picture."""
    angle = 1.1
    model = corner(environment=lopsided())
    turn = np.array([[np.cos(angle), 0, np.sin(angle), 0], [0, 1, 0, 0], [-np.sin(angle), 0, np.cos(angle), 0],
                     [0, 0, 0, 1.0]])
    turned = replace(model, environment=replace(model.environment, rotation=angle),
                     instances=tuple(Instance(i.mesh, turn @ i.transform) for i in model.instances))
    pictures = [radiance(m, orthographic(0.2 + a, 0.9), SIZE, environment_shadows="64")[..., :3]
                for m, a in ((model, 0.0), (turned, angle))]
    assert np.abs(pictures[0] - pictures[1]).mean() < 0.01 * pictures[0].mean()
    other = radiance(turned, orthographic(0.2, 0.9), SIZE, environment_shadows="64")[..., :3]
    assert np.abs(pictures[0] - other).mean() > 0.03 * pictures[0].mean()


def test_lights_and_their_shadows_stay(radiance):
    """A sun beside a black environment, which is all that is drawn from."""
    model = replace(corner(environment=constant(0.0)), lights=(Light.from_angles(0.6, 0.7, 3.0),))
    pictures = [radiance(model, orthographic(0.4, 0.6, height=3.0), SIZE, environment_shadows=lights)
                for lights in ("off", "16")]
    assert pictures[0][..., 0].max() > 0.5
    assert np.array_equal(*pictures)


def test_edges_do_not_take_what_lies_behind_them(radiance):
    """A lit plate over a floor that is dark beneath it: no pixel at its rim is darker than either."""
    model = scene((plate(0, half=2.0), facing_floor()), (plate(0, half=0.7), moved((0, 0.1, 0)) @ facing_floor()),
                  materials=[replace(WHITE, double_sided=True)], environment=constant())
    picture = radiance(model, orthographic(0.0, np.pi / 2, height=1.6), SIZE, environment_shadows="64",
                       antialias="msaa-4")[..., 0]
    assert picture.min() > 0.5 and picture[20:28, 20:28].min() > 0.99


def test_lights_add_up_to_the_environment():
    level = prefilter(lopsided().radiance)[0][1]
    for count in (64, 1024):
        lights = many_lights(level, count)
        assert np.abs(np.linalg.norm(lights.directions, axis=1) - 1).max() < 1e-12
        for n in np.eye(3):
            cosine = np.maximum(lights.directions @ n, 0)
            found = cosine @ lights.irradiance
            rows, columns = np.mgrid[0:256, 0:512]
            theta, phi = np.pi * (rows + 0.5) / 256, 2 * np.pi * ((columns + 0.5) / 512 - 0.5)
            d = np.stack([np.sin(theta) * np.cos(phi), np.cos(theta), np.sin(theta) * np.sin(phi)], axis=-1)
            big = lopsided(256).radiance
            exact = np.einsum("ij,ijc->c", np.sin(theta) * np.maximum(d @ n, 0), big) * (np.pi / 256) ** 2
            assert np.abs(found / exact - 1).max() < 2.0 / count**0.5
        # All of it has a light, and each stands in the middle of what it has: where the lattice of the first places has
        # it, the mean squared distance between light and lights is 2.14 / 64 and 2.17 / 1024.
        assert np.abs(lights.irradiance.sum(axis=0) / level_integral(level) - 1).max() < 1e-5
        assert abs(lights.solid_angles.sum() / (4 * np.pi) - 1) < 1e-12
        light = big.sum(axis=2) * np.sin(theta)
        apart = 2 - 2 * np.stack([(row @ lights.directions.T).max(axis=1) for row in d])
        assert (light * apart).sum() / light.sum() < 2.1 / count


def ridged_floor(count: int = 40) -> Mesh:
    """A metal floor in strips along the wall, that are shaded as if every other one leant to it, and the rest away."""
    edges = np.linspace(-2, 2, count + 1)
    z = np.repeat(np.stack([edges[:-1], edges[1:]], axis=1)[:, :, None], 2, axis=2)
    x = np.broadcast_to([-2.0, 2.0], z.shape)
    lean = np.broadcast_to(0.5 * (-1.0) ** np.arange(count)[:, None, None], z.shape)
    positions = np.stack([x, np.zeros_like(z), z], axis=-1).reshape(-1, 3).astype(np.float32)
    normals = np.stack([np.zeros_like(z), np.cos(lean), np.sin(lean)], axis=-1).reshape(-1, 3).astype(np.float32)
    quads = 4 * np.arange(count)[:, None] + [0, 2, 3, 0, 3, 1]
    return Mesh("ridges", positions, 0, indices=quads.astype(np.uint32).ravel(), normals=normals)


def test_large_pictures_are_interpolated_from_a_bounded_number_of_points(radiance, monkeypatch):
    """A strip does not take the light of those beside it, which face other ways."""
    size = (96, 64)
    shiny = replace(WHITE, metallic=1.0, perceptual_roughness=0.3, double_sided=True)
    flat = corner(environment=lopsided())
    model = replace(flat, meshes=(ridged_floor(), flat.meshes[1]), materials=(shiny, BLACK),
                    instances=(Instance(0, np.eye(4)), flat.instances[1]))
    whole, fewer = [], []
    for points, pictures in ((1 << 20, whole), (96 * 64 // 4, fewer)):
        monkeypatch.setattr("viewer.raster.passes.MOST_POINTS", points)
        pictures += [radiance(model, VIEW, size, environment_shadows=lights)[..., :3] for lights in ("off", "64")]
    assert np.array_equal(whole[0], fewer[0]) and not np.array_equal(whole[1], fewer[1])
    relmse = [((picture - whole[1])**2 / (whole[1]**2 + 0.01)).mean() for picture in (fewer[1], whole[0])]
    assert relmse[0] < 0.01 * relmse[1]


def test_maps_that_lie_where_those_of_other_scenes_lay_are_the_same(renderer, context):
    """16 lights and 64 fill textures of one size; 256 take four, and in between a scene has none. From nearby the maps
    have more texels."""
    ball = scene((sphere(), np.eye(4)), (plate(0, half=2.0), facing_floor()), environment=lopsided())
    near = orthographic(0.4, 0.9, height=0.2)
    shots = [(ball, "64", VIEW), (corner(environment=lopsided()), "16", VIEW),
             (corner(environment=lopsided()), "256", VIEW), (corner(), "off", VIEW),
             (replace(corner(), materials=(WHITE, replace(BLACK, transmission=1.0))), "64", VIEW), (ball, "64", near)]

    def draw(renderer: Renderer, k: int) -> np.ndarray:
        model, lights, view = shots[k]
        return renderer.render(model, view, Settings(antialias="none", environment_shadows=lights), SIZE).linear

    fresh = []
    for k in range(len(shots)):
        other = Renderer(context)
        fresh.append(draw(other, k))
        other.release()
    for k in (0, 5, 0, 1, 0, 2, 1, 3, 5, 0, 4, 0, 4):
        assert np.array_equal(draw(renderer, k), fresh[k])
    assert renderer.context.gl.error == "GL_NO_ERROR"


def test_a_black_environment_gives_no_nan(radiance):
    assert radiance(corner(environment=constant(0.0)), VIEW, SIZE, environment_shadows="16")[..., :3].max() == 0


def test_estimated_light_makes_a_white_corner_in_uniform_light_invisible(radiance):
    """What hides uniform light sends as much if it is white, and nothing if it is black. A mean colour r is between two
    cases on paper, for a share h that is hidden: all that hides sees as much of the sky as the floor does,
    (1 - h) / (1 - r h), or only the floor, (1 - h) / (1 - r^2 h)."""
    white = replace(corner(), materials=(replace(WHITE, double_sided=True),) * 2)
    hidden, found = (radiance(white, VIEW, SIZE, environment_shadows="64", indirect=indirect)[..., :3]
                     for indirect in ("off", "estimated"))
    assert hidden.min() < 0.7 and np.abs(found - 1).max() < 0.01
    color = np.array([0.8, 0.2, 0.0])
    red = replace(white, materials=(replace(WHITE, base_color=(*color, 1.0), double_sided=True),) * 2)
    floor = radiance(red, VIEW, SIZE, environment_shadows="64", indirect="estimated")[..., :3]
    h = 1 - hidden
    least, most = (color * (1 - h) / (1 - r * h) for r in (color**2, color))
    assert (floor > least - 0.02).all() and (floor < most + 0.02).all()
    assert np.abs(floor[20, 24] - color * hidden[20, 24]).max() > 0.05
    black = replace(white, materials=(replace(WHITE, base_color=(0, 0, 0, 1), double_sided=True),) * 2)
    assert not radiance(black, VIEW, SIZE, environment_shadows="64", indirect="estimated")[..., :3].any()


def test_what_lies_close_above_a_floor_is_dark_beneath(radiance):
    """A small plate just above a wide floor hides a bright light above, and hardly gets any light from below. The floor
    beneath is not lit as by the whole lower half of the sky, which is as bright as the upper."""
    grey = replace(WHITE, base_color=(0.8, 0.8, 0.8, 1.0), double_sided=True)
    model = scene((plate(0, half=2.0), facing_floor()), (plate(0, half=0.3), moved((0, 0.03, 0)) @ facing_floor()),
                  materials=[grey], environment=constant())
    below = Camera.look_at((0, 0.015, 0), (0, 0, 1e-4))
    found = radiance(model, below, (8, 8), environment_shadows="64", indirect="estimated")[..., 0]
    assert found.max() < 0.2  # 0.8 * 0.8 by the whole half of the sky


def test_a_body_throws_no_bright_shadow_into_a_dark_sky(radiance):
    """A white post on a floor that faces the dark half of the sky. Where it hides few of the lights, the floor beside
    it is not brighter than by the square of their share, which no edge shows, though the other half is bright."""
    radiances = np.full((32, 64, 3), 0.05, np.float32)
    radiances[16:] = 1.0
    floor = (plate(0, half=2.0), facing_floor())
    bare, post = (scene(*meshes, materials=[replace(WHITE, double_sided=True)],
                        environment=Environment("dark above", radiances))
                  for meshes in ([floor], [floor, (plate(0), moved((0, 0.5, 0), (0.1, 0.5, 1.0)))]))
    alone = radiance(bare, VIEW, SIZE, environment_shadows="64", indirect="estimated")[..., 0]
    hidden, found = (radiance(post, VIEW, SIZE, environment_shadows="64", indirect=indirect)[..., 0]
                     for indirect in ("off", "estimated"))
    beside = (hidden < 0.99 * alone) & (hidden > 0.75 * alone)
    assert beside.sum() > 100 and (found / alone)[beside].max() < 1.07


def test_what_hides_the_sky_shines_as_the_mean_surface(radiance):
    """A black wall that shines by 0.5 beside a white floor whose box has as large a surface: the mean is 0.25, which
    the share h that is hidden sends, and again what of that comes back by reflectances of 0.5."""
    white = replace(corner(), materials=(WHITE, BLACK))
    hidden = radiance(white, VIEW, SIZE, environment_shadows="64")[..., :3]
    shining = replace(white, materials=(WHITE, replace(BLACK, emissive=(0.5, 0.5, 0.5))))
    dark, lit = (radiance(model, VIEW, SIZE, environment_shadows="64", indirect="estimated")[..., :3]
                 for model in (white, shining))
    h = 1 - hidden
    gain = (lit - dark)[h > 0.2] / h[h > 0.2]
    assert gain.min() > 0.24 and gain.max() < 0.25 / (1 - 0.25 * h.max()) + 0.01


def test_fog_knows_roughly_what_a_wall_hides(radiance):
    """Without shadow maps of the environment, surfaces in fog see what hides it from the fog, but for what is near.
    Thin fog changes nothing else."""
    wall = (plate(1), moved((0, 0.5, 0)) @ moved((0, 0, 0), (1.5, 0.5, 1.0)))
    model = scene((plate(0, half=1.5), facing_floor()), wall, materials=[WHITE, BLACK], environment=constant())
    bare, found, exact = (radiance(model, VIEW, SIZE, **settings)[..., 0] for settings in (
        {}, {"fog": 1e-6}, {"environment_shadows": "256"}))
    beside = (np.abs(seen_plane(VIEW, SIZE, (0, 1, 0))[..., 2]) > 0.15) & (bare > 0.9)
    assert np.abs(bare - 1)[beside].max() < 0.01 and exact[beside].min() < 0.7
    assert np.sqrt(np.mean((found - exact)[beside] ** 2)) < 0.6 * np.sqrt(np.mean((bare - exact)[beside] ** 2))
    assert np.corrcoef(found[beside], exact[beside])[0, 1] > 0.9
