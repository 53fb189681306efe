"""Light in glass from surface to surface, where it can be worked out on paper, and beside the path tracer."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from needs import needs
from shapes import WHITE, constant, lopsided, moved, orthographic, plate, scene, sphere

from viewer.plan.planner import plan_scene
from viewer.raster.renderer import Renderer
from viewer.raster.traced.refraction import TracedRefraction
from viewer.scene.material import Material
from viewer.scene.mesh import Mesh
from viewer.scene.scene import Scene
from viewer.settings import Settings
from viewer.trace.tracer import Tracer

SIZE = (48, 48)
FRONT = orthographic(height=0.5)
GLASS = Material(metallic=0.0, perceptual_roughness=0.0, transmission=1.0, thickness=1.0)
TRACED = {"refraction": "traced", "antialias": "none", "background": "none"}
R = ((1.5 - 1) / (1.5 + 1)) ** 2
RED = replace(WHITE, base_color=(0, 0, 0, 1), emissive=(4.0, 1.0, 0.5))


def box(material: int = 0) -> Mesh:
    """From -1 to 1 along each axis, every face with its own normal."""
    positions, normals, indices = [], [], []
    for axis in range(3):
        for sign in (-1, 1):
            n, u = np.zeros(3), np.zeros(3)
            n[axis], u[(axis + 1) % 3] = sign, 1
            w, first = np.cross(n, u), len(positions)
            positions += [n - u - w, n + u - w, n + u + w, n - u + w]
            normals += [n] * 4
            indices += [first, first + 1, first + 2, first, first + 2, first + 3]
    return Mesh("box", np.float32(positions), material, indices=np.uint32(indices), normals=np.float32(normals))


def turned_inside_out(mesh: Mesh) -> Mesh:
    corners = mesh.indices.reshape(-1, 3)[:, ::-1]
    return replace(mesh, indices=np.ascontiguousarray(corners).ravel(), normals=-mesh.normals)


def hollow_ball(**changes: object) -> Scene:
    hole = turned_inside_out(sphere()), moved((0, 0, 0), 0.7)
    return scene(sphere(), hole, materials=[replace(GLASS, **changes)], environment=lopsided())


def middle(renderer: Renderer, model: Scene) -> np.ndarray:
    """RGBA at the picture's centre."""
    picture = renderer.render(model, FRONT, Settings.of(**TRACED), SIZE)
    assert np.isfinite(picture.linear).all()
    return picture.linear[23:25, 23:25].mean(axis=(0, 1))


@pytest.mark.parametrize("roughness", [0.0, 0.4])
@pytest.mark.parametrize("inner", [0.0, 0.7])
def test_clear_glass_vanishes_in_the_furnace(renderer, roughness, inner):
    """Of a thick shell light leaves by way of up to four surfaces; what is caught in it is less than 3 %."""
    glass = replace(GLASS, perceptual_roughness=roughness)
    hole = [(turned_inside_out(sphere()), moved((0, 0, 0), inner))] if inner else []
    model = scene(sphere(), *hole, materials=[glass], environment=constant())
    picture = renderer.render(model, orthographic(height=2.2), Settings.of(**TRACED), SIZE).linear
    inside = picture[..., 3] == 1
    assert inside[24, 24]
    error = np.abs(picture[inside][:, :3] - 1)
    assert error.mean() < 0.03 and np.median(error) < 0.01


@pytest.mark.parametrize("depth", [0.1, 0.4])
def test_a_body_absorbs_and_tints_by_where_its_surfaces_are(renderer, depth):
    """Whatever the material's thickness says; the base colour once, half of it at each surface."""
    glass = replace(GLASS, thickness=7.0, attenuation_distance=0.25, attenuation_color=(0.8, 0.3, 0.05),
                    base_color=(1.0, 0.8, 0.3, 1.0))
    model = scene((box(), moved((0, 0, 0), (1, 1, depth))), materials=[glass], environment=constant())
    kept = np.array([0.8, 0.3, 0.05]) ** (2 * depth / 0.25) * (1.0, 0.8, 0.3)
    assert middle(renderer, model)[:3] == pytest.approx(R + (1 - R) * kept, abs=2e-3)


def test_what_is_opaque_is_seen_through_a_body(renderer):
    model = scene((plate(0), moved((0, 0, -1))), (box(1), moved((0, 0, 0), (1, 1, 0.2))), materials=[RED, GLASS])
    found = middle(renderer, model)
    assert found == pytest.approx([4 * (1 - R), 1 - R, 0.5 * (1 - R), 1], abs=5e-3)


def test_a_body_mirrors_what_stands_before_it(renderer):
    """A ball that shines, beside the pane, where the picture shows it too; black glass but for its surface."""
    lamp = sphere(0, 48), moved((0.9, 0, 0.9), 0.3)
    black = replace(GLASS, base_color=(0, 0, 0, 1))
    model = scene(lamp, (box(1), moved((0, 0, 0), (1, 1, 0.2))), materials=[RED, black], environment=constant(0.01))
    camera = orthographic(azimuth=-0.6, height=3.0)
    found = {kind: renderer.render(model, camera, Settings.of(**TRACED | {"refraction": kind}), SIZE).linear
             for kind in ("screen", "traced")}
    mirrored = found["traced"][..., 0] - found["screen"][..., 0]
    assert mirrored.max() == pytest.approx(4 * R, rel=0.2)  # at 34 degrees a little more than R
    assert 30 < (mirrored > 0.1).sum() < 120


def test_nearer_to_the_path_tracer(renderer):
    """Mean squared relative error of a thick shell."""
    model, camera = hollow_ball(), orthographic(0.4, 0.3, height=2.2)
    tracer = Tracer(renderer.context)
    exposure = tracer.begin(model, camera, Settings.of(mode="path", spp=64, background="none"), SIZE)
    while not exposure.is_done:
        exposure.step(0.25)
    truth = exposure.image().linear.astype(np.float64)
    exposure.release()
    tracer.release()
    inside = truth[..., 3] > 0.99

    def error(kind: str) -> float:
        picture = renderer.render(model, camera, Settings.of(**TRACED | {"refraction": kind}), SIZE).linear
        squares = (picture - truth)[..., :3] ** 2 / (truth[..., :3] ** 2 + 0.01)
        return float(squares[inside].mean())

    assert error("traced") < 0.02 and error("traced") < 0.2 * error("screen")


@needs("embree")
def test_the_tree_in_a_shader_finds_what_embree_finds(renderer):
    model, camera = hollow_ball(attenuation_distance=1.0, attenuation_color=(0.5, 0.7, 0.9)), orthographic(height=2.2)
    own, pictures = renderer._passes.refraction, []
    for kind in ("embree", "bvh"):
        renderer._passes.refraction = TracedRefraction(renderer.context, renderer.programs, renderer._depth, kind)
        pictures.append(renderer.render(model, camera, Settings.of(**TRACED), SIZE).linear)
        renderer._passes.refraction.release()
    renderer._passes.refraction = own
    differ = np.abs(pictures[0] - pictures[1]).max(axis=2) > 1e-3
    assert differ.mean() < 0.01


EXTREME = {
    "no index": {"ior": 1.0}, "a large index": {"ior": 100.0}, "index 0": {"ior": 0.0},
    "black": {"ior": 1.0, "thickness": 1e6, "attenuation_distance": 1e-9, "attenuation_color": (0.0, 1.0, 0.5)},
    "dark and rough": {"base_color": (0.0, 0.0, 0.0, 1.0), "perceptual_roughness": 1.0, "thickness": 1e-6},
}


@pytest.mark.parametrize("name", EXTREME)
def test_every_pixel_is_finite(renderer, name):
    """Of a ball, one inside out, a sheet that is open, a coarse ball and one that is flat."""
    ball = sphere(segments=24)
    model = scene(ball, (turned_inside_out(ball), moved((2, 0, 0))), (plate(), moved((-2, 0, 0))),
                  (sphere(segments=6), moved((0, 2, 0))), (ball, moved((0, -2, 0), (1, 0, 1))),
                  materials=[replace(GLASS, **EXTREME[name])], environment=lopsided())
    for samples in ("none", "msaa-4", "ssaa-4"):
        settings = Settings.of(**TRACED | {"antialias": samples})
        picture = renderer.render(model, orthographic(0.3, 0.2, height=6.0), settings, SIZE).linear
        assert np.isfinite(picture).all() and picture.min() >= 0


def test_parts_sizes_and_scenes_in_turn(renderer):
    """Nothing is kept that does not hold."""
    camera, settings = orthographic(0.4, 0.3, height=2.2), Settings.of(**TRACED)
    ball = scene(sphere(), materials=[GLASS], environment=lopsided())
    first = renderer.render(hollow_ball(), camera, settings, SIZE).linear
    other = renderer.render(ball, camera, settings, (31, 17)).linear
    assert other.shape == (17, 31, 4) and other[8, 15, 3] == 1
    assert np.abs(renderer.render(ball, camera, settings, SIZE).linear - first).max() > 0.1
    assert np.array_equal(renderer.render(hollow_ball(), camera, settings, SIZE).linear, first)
    renderer.draw(hollow_ball(), camera, settings, SIZE, half=False, part=(0, 0, 20, 48))
    renderer.draw(hollow_ball(), camera, settings, SIZE, half=False, part=(20, 0, 28, 48))
    assert np.array_equal(renderer.read_radiance(), first)


def test_a_plan_that_leaves_nothing_out_draws_the_same(renderer):
    camera, settings = orthographic(0.4, 0.3, height=2.2), Settings.of(**TRACED)
    needed = renderer.render(hollow_ball(), camera, settings, SIZE).linear
    everything = renderer.render(hollow_ball(), camera, replace(settings, plan="everything"), SIZE).linear
    assert renderer.plan.is_everything and renderer.plan.has_traced_refraction
    assert np.abs(everything - needed).max() < 2e-3


def test_only_bodies_are_traced():
    def planned(material: Material, **settings: object):
        return plan_scene(scene(sphere(), materials=[material], environment=constant()), Settings.of(**settings), [],
                          samples=1, half_target=False, orthographic=False)

    assert planned(GLASS, refraction="traced").has_traced_refraction
    assert not planned(GLASS).has_traced_refraction
    assert not planned(replace(GLASS, thickness=0.0), refraction="traced").has_traced_refraction
    assert not planned(GLASS, refraction="traced", lobes="uniform-diffuse").has_traced_refraction
    assert not planned(GLASS, refraction="traced", mode="phong").has_traced_refraction
