"""Light that solids scatter inside: against half-spaces, slabs and balls whose light is known, and against paths."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from shapes import constant, moved, orthographic, plate, scene, sphere

from viewer.bake.half_space import fresnel, internal_reflectance, returned_light
from viewer.bake.interior import interior_of
from viewer.raster.interiors import Interiors
from viewer.scene.camera import Camera
from viewer.scene.light import Light
from viewer.scene.material import Material
from viewer.scene.medium import Medium
from viewer.scene.mesh import Mesh
from viewer.scene.scene import Scene
from viewer.settings import Settings
from viewer.trace import chords
from viewer.trace.chords import light_behind, thickness_at_vertices
from viewer.trace.tracer import Tracer
from viewer.trace.vertex_light import VertexLight

SIZE = (48, 48)
CAMERA = orthographic(0.4, 0.3, height=2.4)
METHODS = ("slab", "screen")
SOLID = Material(metallic=0.0, perceptual_roughness=0.3, transmission=1.0, ior=1.4, thickness=2.0)


def filled(sigma_t: float, color: tuple[float, ...] = (1.0,) * 3, unit: float = 1.0, **more) -> Material:
    """A solid with a medium of this extinction per unit, whose multiple-scattering albedo is `color`."""
    return replace(SOLID, attenuation_distance=unit / sigma_t, attenuation_color=(math.exp(-1.0),) * 3,
                   scatter_color=color, **more)


def ball(material: Material, lights=(), environment=None, radius: float = 1.0):
    environment = constant() if environment is None else environment
    return scene((sphere(segments=48), moved((0, 0, 0), radius)), materials=[material], lights=lights,
                 environment=environment)


def box(half: tuple[float, float, float]) -> Mesh:
    """A closed box about the origin, with a normal to each face."""
    faces = []
    for axis in range(3):
        for side in (-1.0, 1.0):
            a, b = np.eye(3)[(axis + 1) % 3], np.eye(3)[(axis + 2) % 3] * side
            n = np.eye(3)[axis] * side
            faces.append((n, [n - a - b, n + a - b, n + a + b, n - a + b]))
    positions = np.concatenate([corners for _, corners in faces]) * half
    normals = np.concatenate([[n] * 4 for n, _ in faces])
    index = np.concatenate([np.array([0, 1, 2, 0, 2, 3]) + 4 * k for k in range(6)])
    return Mesh("box", np.float32(positions), 0, indices=np.uint32(index), normals=np.float32(normals))


@pytest.mark.parametrize(("method", "layers"), [
    ("slab", {}), ("screen", {"scatter_anisotropy": 0.9, "perceptual_roughness": 1.0, "ior": 2.0}),
    ("screen", {"ior": 1.0, "perceptual_roughness": 0.0}),
    ("screen", {"transmission": 0.5, "diffuse_transmission": 0.5})], ids=str)
def test_a_white_medium_vanishes_in_a_furnace(radiance, method, layers):
    for sigma_t, error in ((1e-6, 4e-3), (0.3, 4e-3), (20.0, 1e-4), (1e6, 1e-4)):  # clear glass is 0.003 off
        picture = radiance(ball(filled(sigma_t, **layers)), CAMERA, SIZE, subsurface=method)
        assert np.abs(picture[..., :3] - 1).max() < error, sigma_t


@pytest.mark.parametrize("color", [0.2, 0.6, 0.9])
@pytest.mark.parametrize("ior", [1.0, 1.4])
def test_a_thick_solid_is_a_half_space(radiance, color, ior):
    """Seen along the normal, in light from all around: the reflection, and the share that returns of what enters."""
    material = filled(1e4, (color,) * 3, ior=ior, perceptual_roughness=0.0)
    picture = radiance(scene(box((1, 1, 1)), materials=[material], environment=constant()),
                       Camera.look_at((0, 0, 5), (0, 0, 0), fov_y=0.2), SIZE, fresnel="exact", subsurface="slab")
    albedo = material.medium.albedo[0]
    share = returned_light(albedo, 0.0, ior)
    f0 = ((ior - 1) / (ior + 1)) ** 2
    assert abs(picture[24, 24, 0] - (f0 + (1 - f0) * share)) < 0.004


@pytest.mark.parametrize("g", [0.0, 0.5])
@pytest.mark.parametrize("albedo", [1.0, 0.97, 0.5])
def test_slabs_and_balls_have_the_limits_of_thin_and_thick(gl, albedo, g):
    """Slabs against two streams: R and T of the half-space's R and k, as Kubelka & Munk have them; in thin bodies of
    little absorption, what is absorbed is sigma_a times the mean chord, whatever the shape."""
    medium = Medium((1.0,) * 3, (albedo,) * 3, g)
    inside = interior_of(medium, 1.0)
    d = np.geomspace(0.1, 30, 8)

    def shares(roundness):
        interior = gl.call("raster/interior.glsl", "interior_of", k=inside.attenuation, h=inside.extrapolation,
                           entered=inside.entered, thickness=d, roundness=roundness * np.array(inside.albedo),
                           through=1e4, reduced=1e4)
        found = gl.call("raster/interior.glsl", "leaving_light", inside=interior, reflected=0.0)
        return [found[name][:, 0].astype(float) for name in ("own", "other", "everywhere")]

    own, other, everywhere = shares(0.0)
    if albedo < 1:
        r, e = returned_light(albedo, g, 1.0), np.exp(-inside.attenuation[0] * d)
        expected = r * (1 - e * e) / (1 - r * r * e * e), (1 - r * r) * e / (1 - r * r * e * e)
    else:
        passed = 1 / (1 + 0.5 * d / inside.extrapolation[0])
        expected = 1 - passed, passed
    assert np.abs(own - expected[0]).max() < 1e-4 and np.abs(other - expected[1]).max() < 1e-4
    assert np.abs(everywhere).max() < 1e-6
    of_ball = sum(shares(1.0))  # of light that is the same from everywhere
    assert np.all(of_ball <= 1 + 1e-6) and np.all(of_ball >= own + other - 1e-4)
    if albedo == 0.97:
        thin = 1 - of_ball[0]
        assert abs(thin / ((1 - albedo) * 2 * d[0]) - 1) < 0.15


WALKS = {  # of 60 000 photons, whose noise is below 0.004
    ("slab", 1.4, 0.999): (0.385, 0.349), ("slab", 5.0, 0.999): (0.633, 0.313),
    ("slab", 1.4, 0.95): (0.283, 0.250), ("slab", 5.0, 0.95): (0.355, 0.113),
    ("ball", 1.0, 0.999): (0.205, 0.177, 0.171, 0.175, 0.186, 0.198, 0.207, 0.215),
    ("ball", 2.5, 0.999): (0.146, 0.153, 0.165, 0.184, 0.225, 0.276, 0.310, 0.350),
    ("ball", 8.0, 0.999): (0.038, 0.051, 0.071, 0.111, 0.199, 0.318, 0.451, 0.567),
    ("ball", 2.5, 0.95): (0.098, 0.100, 0.115, 0.131, 0.163, 0.203, 0.242, 0.273)}
"""By shape, its thickness or radius in mean free paths, and albedo, behind a smooth boundary of index 1.4 in a sun of
irradiance 1: what a slab sends back and lets through of light along its normal, and the exitance of a ball in eight
equal parts of the cosine to the sun, from behind to in front."""


@pytest.mark.parametrize(("shape", "size", "albedo"), WALKS)
def test_suns_on_slabs_and_balls_are_as_random_walks(gl, shape, size, albedo):
    """The share of all harmonics, without the light that passes unscattered."""
    inside = interior_of(Medium((1.0,) * 3, (albedo,) * 3, 0.0), 1.4)
    is_ball = shape == "ball"
    through = 2 * size if is_ball else size
    interior = gl.call("raster/interior.glsl", "interior_of", k=inside.attenuation, h=inside.extrapolation,
                       entered=inside.entered, thickness=np.array([size / 1.5 if is_ball else size]),
                       roundness=is_ball * np.array(inside.albedo), through=through, reduced=through)
    found = gl.call("raster/interior.glsl", "leaving_light", inside=interior,
                    reflected=(inside.trapped - 1) / (inside.trapped + 1))
    own, other, everywhere = (found[name][0, 0].astype(float) for name in ("own", "other", "everywhere"))
    walked = np.array(WALKS[shape, size, albedo])
    entering = 1 - fresnel(np.array([1.0]), 1.4)[0]
    if not is_ball:
        assert np.abs(np.array([own, other]) * entering - walked).max() < 0.03
        return
    cosine = np.linspace(-1, 1, 9)[:-1] + 0.125
    mean_entering = 1 - internal_reflectance(1 / 1.4)
    lit = np.where(cosine > 0, 1 - fresnel(np.abs(cosine), 1.4), mean_entering)
    leaving = everywhere / 4 * mean_entering + lit * np.where(cosine > 0, own, other) * np.abs(cosine)
    assert np.abs(leaving - walked).max() < 0.055 and np.abs(leaving - walked).mean() < 0.025
    assert abs(leaving.mean() / walked.mean() - 1) < 0.05


def test_thickness_of_a_slab_and_a_ball(context):
    model = scene((box((1, 1, 0.05)), moved((0, 0, 0))), (sphere(segments=48), moved((4, 0, 0), 0.5)),
                  materials=[SOLID])
    slab, round_ = (thickness_at_vertices(context, model, [0, 1])[k][:, :2] * [model.radius, 1] for k in (0, 1))
    assert np.abs(round_[:, 0] - 1 / 3).max() < 0.02 and round_[:, 1].min() > 0.9
    front = slab[8:]  # the last faces are those of +-z
    assert np.median(front[-8:, 0]) < 0.12 and front[-8:, 1].max() < 0.35


def test_light_that_waits_behind_a_sheet(context):
    sheet = scene(box((1, 1, 0.02)), materials=[SOLID])
    lit = np.zeros((24, 4), np.float32)
    lit[16:20] = 1, 2, 3, 0.5  # the face towards -z
    behind = light_behind(context, sheet, [0], VertexLight((lit,)))[0]
    assert np.abs(behind[20:24] - lit[16]).max() < 0.3 and np.abs(behind[16:20]).max() < 0.3


def test_light_bleeds_into_the_shadow_and_red_goes_farthest(radiance):
    """Half of a wall of wax is in the sun. At each point alone, the edge of the shadow is as sharp as on stone."""
    wax = replace(filled(1.0, (0.8, 0.8, 0.8)), attenuation_color=(0.5, 0.2, 0.02), attenuation_distance=0.03)
    model = scene(box((1, 1, 1)), (plate(1), moved((-1.0, 0, 1.5))), materials=[wax, Material(double_sided=True)],
                  lights=(Light("directional", intensity=3.0, direction=(0, 0, -1)),))
    camera = Camera.look_at((3, 0, 4), (0, 0, 1), fov_y=0.1)
    slab, screen = (radiance(model, camera, (96, 24), subsurface=method, background="none")[12, :, :3]
                    for method in METHODS)
    edge = 30 + int(np.argmax(slab[30:, 0] > 0.5 * slab[70, 0]))  # to the left there is the plate
    sun = screen[edge + 30]
    assert slab[edge - 15:edge - 3].max() < 0.02 * sun.min() and np.abs(slab[edge + 30] / sun - 1).max() < 0.05
    near, far = screen[edge - 3] / sun, screen[edge - 10] / sun
    assert near[0] > near[1] > near[2] > 0.001 and 0.02 < far[0] < 0.6 * near[0]
    assert screen[edge + 3, 0] < 0.9 * sun[0]  # where the light in the shadow has come from


def test_a_moving_camera_spreads_the_same_light(renderer):
    """By fewer points, where the CPU renders."""
    model = ball(filled(5.0, (0.8,) * 3), (Light("directional", intensity=2.0, direction=(-1, 0, 0)),))
    pictures = []
    for still in (False, True):
        renderer.draw(model, CAMERA, Settings.of(antialias="none"), SIZE, half=False, still=still)
        pictures.append(renderer.read_radiance()[..., :3].astype(float))
    assert abs(pictures[0].mean() / pictures[1].mean() - 1) < 0.01
    assert (np.abs(pictures[0] - pictures[1]).max() > 0) == renderer.context.is_software


def test_light_comes_through_a_thin_sheet_and_not_through_a_thick_one(radiance):
    """Scattered, as it is seen beside the way straight through."""
    light = Light("directional", intensity=3.0, direction=(0, 0, 1))
    seen = [radiance(scene(box((1, 1, half)), materials=[filled(10.0, (0.9,) * 3)], lights=(light,)),
                     Camera.look_at((5, 0, 5), (0, 0, 0), fov_y=0.2), (8, 8), background="none")[4, 4, 0]
            for half in (0.1, 0.3, 1.0)]
    assert seen[0] > 1.3 * seen[1] > 4 * seen[2]
    assert seen[0] < 3.0 / np.pi


@pytest.mark.parametrize("angle", [0.0, 0.14])
def test_a_lamp_is_seen_through_a_thin_sheet(radiance, context, angle):
    """Blurred by both of its rough faces, as in mode path. What is scattered inside is a tenth of it or less."""
    light = Light("directional", intensity=3.0, direction=(math.sin(angle), 0, math.cos(angle)))
    sheet = replace(filled(10.0, (0.5,) * 3), perceptual_roughness=0.5)
    model = scene(box((1, 1, 0.02)), materials=[sheet], lights=(light,))
    camera, settings = Camera.look_at((0, 0, 6), (0, 0, 0), fov_y=0.1), {"background": "none", "multiscatter": "off"}
    found = radiance(model, camera, (8, 8), **settings)[..., :3].mean()
    paths = Tracer(context).render(model, camera, Settings.of(mode="path", spp=128, **settings), (8, 8)).linear[..., :3]
    assert found == pytest.approx(paths.mean(), rel=0.25)


@pytest.mark.parametrize("unit", [1e-6, 1e6])
def test_the_size_of_the_world_does_not_matter(radiance, unit):
    lights = (Light("directional", intensity=2.0, direction=(-1, -0.02, -0.2)),)
    camera = CAMERA
    pictures = [radiance(ball(filled(8.0, (0.8, 0.6, 0.4), unit=size), lights, radius=size),
                         Camera(np.block([[camera.pose[:3, :3], size * camera.pose[:3, 3:]], [np.zeros((1, 3)), 1]]),
                                camera.fov_y, size * camera.height), SIZE)
                for size in (1.0, unit)]
    assert np.abs(pictures[0] - pictures[1]).max() < 2e-3 * pictures[0].max()


@pytest.mark.parametrize("sigma_t", [1e-6, 1.0, 1e6])
@pytest.mark.parametrize("color", [0.0, 1e-4, 1.0])
def test_extreme_media_are_finite_and_do_not_shine(radiance, sigma_t, color):
    material = filled(sigma_t, (color, 1.0, 0.5), scatter_anisotropy=-0.99)
    grazing = Light("directional", intensity=np.pi, direction=(-1, 0, 1e-3))
    for lights in ((), (grazing,)):
        picture = radiance(ball(material, lights), CAMERA, SIZE)
        assert picture[..., :3].max() <= (1.003 if not lights else 1e3)


def test_only_scenes_with_scattering_solids_have_the_pass(renderer, radiance):
    for material, methods in ((SOLID, METHODS), (filled(5.0), ("off",))):
        for method in methods:
            radiance(ball(material), CAMERA, SIZE, subsurface=method)
            plan = renderer.plan.to_json()
            assert "subsurface" not in plan["passes"]
            assert not any("SUBSURFACE" in program["on"] for program in plan["programs"])
    radiance(ball(filled(5.0)), CAMERA, SIZE)
    plan = renderer.plan.to_json()
    assert "subsurface" in plan["passes"] and any("subsurface scattering in 1 solid" in line for line in plan["used"])


@pytest.mark.parametrize("perceptual_roughness", [0.0, 0.6])
def test_a_ball_of_wax_against_paths(context, radiance, perceptual_roughness):
    """Without the medium, nine tenths of its light are missing; a rough boundary whose facets scatter once loses a
    fifth."""
    settings = {"fresnel": "exact", "multiscatter": "off"}
    material = filled(10.0, (0.8, 0.65, 0.5), perceptual_roughness=perceptual_roughness)
    model = ball(material)
    tracer = Tracer(context)
    try:
        paths = tracer.render(model, CAMERA, Settings.of(mode="path", spp=24, bounces=255, **settings), (16, 16))
    finally:
        tracer.release()
    picture = radiance(model, CAMERA, (16, 16), **settings)
    inside = (slice(5, 11), slice(5, 11))
    assert np.abs(picture[inside].mean(axis=(0, 1)) / paths.linear[inside].mean(axis=(0, 1)) - 1)[:3].max() < 0.1



def test_only_solids_full_of_a_dense_medium_keep_the_sky_from_others(radiance):
    """A ball over a floor, seen from the side: of what is under it."""
    def under(sigma_t: float) -> float:
        floor = replace(plate(3), material=1)
        lying = np.array([[1, 0, 0, 0], [0, 0, 1, -1.0], [0, -1, 0, 0], [0, 0, 0, 1.0]])
        model = scene((sphere(segments=16), moved((0, 0, 0), 1.0)), (floor, lying), environment=constant(),
                      materials=[filled(sigma_t), Material(metallic=0.0, specular=0.0)])
        camera = Camera.look_at((0, 0.4, 8), (0, -1, 0.3), fov_y=0.1)
        return float(radiance(model, camera, (8, 8), environment_shadows="16")[4, 4, 1])

    assert under(20.0) < 0.6 * under(0.1)


def test_the_thickness_of_solids_that_stand_still_is_kept(renderer, monkeypatch):
    """Nor is it measured anew of one that is only moved or scaled, and a picture is that of a fresh renderer."""
    counted = []
    monkeypatch.setattr(chords, "thickness_at_vertices",
                        lambda *given: counted.append(given) or thickness_at_vertices(*given))
    solid, plain = filled(3.0, (0.9, 0.6, 0.3)), Material()
    meshes = sphere(segments=12), replace(sphere(segments=12), material=1)

    def picture(x: float, mark: float, materials=(solid, plain), size=0.5) -> np.ndarray:
        placed = scene((meshes[0], moved((x, 0, 0), size)), (meshes[1], moved((0, mark, 0), 0.1)),
                       (meshes[1], moved((2, 2, 2), 0.1)), (meshes[1], moved((-2, -2, -2), 0.1)),
                       materials=list(materials), environment=constant())
        return renderer.render(placed, CAMERA, Settings(), SIZE).linear

    first = picture(0.0, 1.0)
    for given, count in (((0.0, 0.9), 1), ((0.2, 0.9), 1), ((0.0, 1.0, (solid, solid)), 2),
                         ((0.0, 1.0, (plain, plain)), 2)):
        picture(*given)
        assert len(counted) == count
    assert np.array_equal(picture(0.0, 1.0), first) and len(counted) == 3
    kept = picture(0.2, 1.0, size=0.3)
    assert len(counted) == 3
    picture(0.2, 1.0, size=(0.3, 0.5, 0.3))
    assert len(counted) == 4
    anew = picture(0.2, 1.0, size=0.3)
    assert len(counted) == 5 and np.abs(kept - anew).max() < 0.02 * anew.max()


def test_solids_that_touch_have_to_move_as_one(monkeypatch):
    """Of two balls, one moves: their thickness is kept if they are apart, before and after."""
    mesh = sphere(segments=8)

    def pair(x: float, turn: float = 0.0) -> Scene:
        rotation = np.eye(4)
        rotation[:2, :2] = [[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]]
        return scene((mesh, rotation), (mesh, rotation @ moved((x, 0, 0), 0.5)))

    counted = []
    monkeypatch.setattr(chords, "thickness_at_vertices",
                        lambda *given: counted.append(given) or {k: np.ones((1, 7), np.float32) for k in (0, 1)})
    for first, second, is_kept in ((pair(3.0), pair(4.0), True), (pair(3.0), pair(1.2), False),
                                   (pair(1.2), pair(3.0), False), (pair(1.2), pair(1.2, 0.7), True)):
        interiors = Interiors(None)
        counted.clear()
        interiors.take(first, [0, 1])
        found = interiors.take(second, [0, 1])
        assert len(counted) == 2 - is_kept
        if is_kept and first.radius != second.radius:
            assert [found[k][0, 0] for k in (0, 1)] == pytest.approx([first.radius / second.radius] * 2)
