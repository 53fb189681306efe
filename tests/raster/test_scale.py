"""The same scene in any unit, anywhere, mirrored, from inside: the same picture."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from shapes import WHITE, facing_floor, lopsided, moved, orthographic, plate, scene, sphere

from viewer.image.image import Image
from viewer.measure.compare.difference import compare
from viewer.scene.camera import Camera
from viewer.scene.light import Light
from viewer.scene.material import Material
from viewer.scene.scene import Scene
from viewer.settings import Settings

SIZE = (64, 64)
MATERIALS = (Material(base_color=(0.8, 0.2, 0.1, 1), metallic=0.0, perceptual_roughness=0.4),
             Material(base_color=(0.9, 0.8, 0.5, 1), perceptual_roughness=0.3), WHITE,
             Material(base_color=(0.2, 0.4, 0.9, 0.5), metallic=0.0, alpha_mode="blend", double_sided=True))
CAMERA = Camera.orbit((0, 0.4, 0), 6.0, 0.5, 0.4)


def still_life(scale: float = 1.0, offset=(0.0, 0.0, 0.0)) -> tuple[Scene, Camera]:
    """Balls on a floor behind a pane, under all kinds of light, and a camera; all of it scaled, then moved."""
    place = moved(offset, scale)
    things = [(plate(2, half=3.0), facing_floor()), (sphere(0, 48), moved((-0.8, 0.6, 0), 0.6)),
              (sphere(1, 48), moved((0.7, 0.5, 0.3), 0.5)), (plate(3, half=0.5), moved((0, 0.7, 1.2)))]
    at = [tuple(place[:3, :3] @ p + place[:3, 3]) for p in ((1.5, 1.5, 1.0), (-1.5, 2.5, 0.5))]
    lights = (Light.from_angles(-0.8, 0.9, 1.5), Light("point", (1, 0.5, 0.3), 4.0 * scale**2, at[0], range=6 * scale),
              Light("spot", (0.3, 1, 0.4), 9.0 * scale**2, at[1], (0.5, -0.84, -0.2), outer_cone=0.5))
    model = scene(*((mesh, place @ matrix) for mesh, matrix in things), materials=MATERIALS, lights=lights,
                  environment=lopsided())
    pose = CAMERA.pose.copy()
    pose[:3, 3] = place[:3, :3] @ pose[:3, 3] + place[:3, 3]
    return model, replace(CAMERA, pose=pose)


@pytest.fixture
def draw(renderer):
    def run(model: Scene, camera: Camera, **settings: object) -> Image:
        image = renderer.render(model, camera, Settings.of(**{"antialias": "msaa-4"} | settings), SIZE)
        assert np.isfinite(image.linear).all()
        return image

    yield run
    assert renderer.context.gl.error == "GL_NO_ERROR"


@pytest.mark.parametrize("mode", ["pbr", "phong"])
@pytest.mark.parametrize("scale", [2.0**-20, 2.0**20])
def test_powers_of_two_change_no_bit(draw, scale, mode):
    assert np.array_equal(draw(*still_life(scale), mode=mode).linear, draw(*still_life(), mode=mode).linear)


@pytest.mark.parametrize("scale", [1e-6, 1e-3, 1e3, 1e6])
def test_scale(draw, scale):
    assert compare(draw(*still_life()), draw(*still_life(scale))).flip < 0.0005


@pytest.mark.parametrize(("scale", "offset"), [(1.0, (1e6, -1e6, 1e6)), (1e-3, (1e3, 1e3, -1e3)), (1e6, (1e9, 0, 1e9))])
def test_place(draw, scale, offset):
    """A million of its own sizes from the origin."""
    assert compare(draw(*still_life()), draw(*still_life(scale, offset))).flip < 0.0005


def test_numbers_far_from_the_mesh_s_origin(draw):
    """Vertices near 1000, brought back by the node: what float32 vertices still hold (6e-5) is all that is lost."""
    model, camera = still_life()
    meshes, instances = [], []
    for instance in model.instances:
        mesh = model.meshes[instance.mesh]
        meshes.append(replace(mesh, positions=mesh.positions + np.float32(1000)))
        instances.append(replace(instance, transform=instance.transform @ moved((-1000, -1000, -1000))))
    away = replace(model, meshes=tuple(meshes), instances=tuple(instances))
    assert compare(draw(model, camera), draw(away, camera)).flip < 0.002


@pytest.mark.parametrize(("pane", "settings"), [("opaque", {}), ("blend", {"shadows": "off"})])
def test_mirrored_by_a_negative_scale(draw, pane, settings):
    """The mirror image of everything is the picture, mirrored: front faces, normals, tangents and all.

    A blended pane is drawn without shadows, since which texels of its shadow let light through is not mirrored.
    """
    model, camera = still_life()
    model = replace(model, materials=(*model.materials[:3], replace(model.materials[3], alpha_mode=pane)))
    mirror = np.diag([-1.0, 1, 1, 1])
    lights = tuple(replace(light, position=tuple(mirror[:3, :3] @ light.position),
                           direction=tuple(mirror[:3, :3] @ light.direction)) for light in model.lights)
    mirrored = replace(model, lights=lights, environment=None,
                       instances=tuple(replace(i, transform=mirror @ i.transform) for i in model.instances))
    pose = camera.pose.copy()
    pose[:3] = mirror[:3, :3] @ pose[:3]
    pose[:3, 0] *= -1
    # One sample, in the middle of the pixel: where four of them lie is not symmetric.
    picture = draw(mirrored, replace(camera, pose=pose), background="none", antialias="none", **settings).linear
    straight = draw(replace(model, environment=None), camera, background="none", antialias="none", **settings).linear
    assert np.abs(picture[:, ::-1] - straight).max() < 1e-3


def test_camera_inside_the_scene(draw):
    """In a closed room of radius 1 with a ball of 1/500 of it near the eye: both are there."""
    room = replace(WHITE, double_sided=True)
    bead = Material(base_color=(1, 0, 0, 1), unlit=True)
    model = scene(sphere(0, 48), (sphere(1, 24), moved((0.3, 0.1, 0.2 - 0.01), 0.002)), materials=[room, bead],
                  lights=(Light("point", intensity=3.0, position=(0, 0.5, 0)),))
    camera = Camera.look_at((0.3, 0.1, 0.2), (0.3, 0.1, -1.0))
    picture = draw(model, camera, background="none", shadows="off").linear
    assert (picture[..., 3] == 1).all()
    assert picture[32, 32].tolist() == [1, 0, 0, 1]
    red = (picture[..., 1] == 0).mean()
    assert red == pytest.approx(np.pi * (0.002 / 0.01 / 2 / np.tan(np.pi / 8)) ** 2, rel=0.1)
    assert picture[0, 0, :3].min() > 0.05


def test_camera_looking_away_sees_the_background(draw):
    model, camera = still_life()
    away = Camera.look_at(camera.eye, 2 * camera.eye)
    assert np.array_equal(draw(model, away).linear, draw(Scene("empty", environment=model.environment), away).linear)


@pytest.mark.parametrize("height", [2.5, 5.0])
def test_orthographic_camera(draw, height):
    """A ball of radius 1 is a disk of radius 1, wherever the eye stands along the view."""
    ball = scene(sphere(), materials=[Material(unlit=True)])
    pictures = [draw(ball, orthographic(0.3, 0.2, height, distance), background="none").linear[..., 3]
                for distance in (1e-3, 3.0, 1e4)]
    assert pictures[0].mean() == pytest.approx(np.pi / height**2, rel=0.01)
    assert np.abs(pictures[1] - pictures[0]).max() <= 0.25 and np.abs(pictures[2] - pictures[0]).max() <= 0.25
