"""The photons of the guide to caustics: what they carry, and the laws by which balls send them on."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from needs import needs
from shapes import facing_floor, moved, plate, scene, sphere

from viewer.scene.color import LUMINANCE
from viewer.scene.environment import Environment
from viewer.scene.equirect import texel_directions, texel_solid_angles
from viewer.scene.material import Material
from viewer.scene.scene import Instance, Scene
from viewer.settings import Settings
from viewer.trace.scene.caustic_rays import Caster, CausticRays, casters_of, caustic_rays
from viewer.trace.scene.geometry import TraceGeometry, trace_geometry
from viewer.trace.scene.lights import SceneLights
from viewer.trace.scene.scene_buffer import SceneBufferBuilder

pytestmark = needs("embree")
FLOOR = Material("floor", metallic=0.0, perceptual_roughness=0.9)
METAL = Material("metal", metallic=1.0, perceptual_roughness=0.0)
GLASS = Material("glass", metallic=0.0, transmission=1.0, thickness=1.0, perceptual_roughness=0.0)
LAMP = Material("lamp", emissive=(60.0, 60.0, 60.0))
CENTER, RADIUS = np.array([0.5, 0.0, 0.3]), 0.4
TURN = np.array([[1, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1]], float)  # about X: poles lie along Z


def beside_floor(material: Material, *lamps: tuple[Material, np.ndarray], environment=None) -> Scene:
    """A ball over a wide floor, and plates that shine."""
    placed = [(plate(2 + k, 0.2), matrix) for k, (_, matrix) in enumerate(lamps)]
    return scene((plate(0, 40.0), facing_floor(y=-1.0)), (sphere(1, 48), moved(CENTER, RADIUS) @ TURN), *placed,
                 materials=[FLOOR, material, *(lamp for lamp, _ in lamps)], environment=environment)


def traced(model: Scene) -> tuple[TraceGeometry, list[Caster], CausticRays]:
    from viewer.trace.rays.embree_triangles import EmbreeTriangles

    geometry = trace_geometry(model)
    lights = SceneLights(None, model, geometry, SceneBufferBuilder(), Settings())
    casters = casters_of(geometry, 0.6, 4)
    return geometry, casters, caustic_rays(model, geometry, EmbreeTriangles(geometry), casters, *lights.emitters,
                                           model.environment)


def sun(rotation: float) -> tuple[Environment, np.ndarray, float]:
    """One bright texel, the direction to it in the world, and the irradiance of what faces it."""
    pixels = np.zeros((32, 64, 3), np.float32)
    pixels[6, 40] = 1000.0
    direction, angle = texel_directions(32, 64)[6, 40], texel_solid_angles(32, 64)[6]
    c, s = np.cos(rotation), np.sin(rotation)
    turned = np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]]) @ direction  # as `rotation_about_y` transposed
    environment = replace(Environment("sun", pixels), rotation=rotation)
    return environment, turned, float(pixels[6, 40] @ LUMINANCE * angle)


def seen_normals(rays: CausticRays, caster: Caster) -> np.ndarray:
    """The ball's normals where the rays come from it, (N, 3)."""
    to = rays.point - caster.center
    along = (to * rays.direction).sum(axis=1)
    t = -along - np.sqrt(np.maximum(along**2 - (to**2).sum(axis=1) + caster.radius**2, 0.0))
    return (to + t[:, None] * rays.direction) / caster.radius


def test_a_ball_of_metal_mirrors_a_sun() -> None:
    """By the law of reflection; and of E pi r^2 the floor gets what is reflected downwards."""
    environment, to_sun, irradiance = sun(0.8)
    _, (caster,), rays = traced(beside_floor(METAL, environment=environment))
    n = seen_normals(rays, caster)
    mirrored = rays.direction - 2 * (n * rays.direction).sum(axis=1, keepdims=True) * n
    assert np.median(mirrored @ to_sun) > 0.998  # of a texel of 6 degrees
    # A ball reflects a sun evenly to all sides, so that half of it goes down, and little of that misses the floor.
    assert rays.flux.sum() == pytest.approx(0.5 * irradiance * np.pi * caster.radius**2, rel=0.05)


def test_each_of_two_balls_has_its_own_light() -> None:
    """One with a quarter of the other's disk."""
    environment, _, irradiance = sun(0.0)
    model = beside_floor(METAL, environment=environment)
    small = sphere(1, 48), moved((-1.5, 0.0, 0.3), RADIUS / 2)
    model = replace(model, meshes=(*model.meshes, replace(small[0], material=1)),
                    instances=(*model.instances, Instance(len(model.meshes), small[1])))
    geometry, casters, rays = traced(model)
    assert [caster.radius * geometry.unit for caster in casters] == pytest.approx([RADIUS, RADIUS / 2], rel=1e-3)
    flux = np.bincount(rays.caster, rays.flux)
    assert flux[1] / flux[0] == pytest.approx(0.25, rel=0.05)
    assert flux[0] == pytest.approx(0.5 * irradiance * np.pi * casters[0].radius**2, rel=0.05)


def test_a_ball_of_glass_gathers_a_sun() -> None:
    """All but about a tenth, which it reflects, goes on, bent by less than 60 degrees."""
    environment, to_sun, irradiance = sun(-0.5)
    _, (caster,), rays = traced(beside_floor(GLASS, environment=environment))
    assert rays.flux.sum() == pytest.approx(0.89 * irradiance * np.pi * caster.radius**2, rel=0.05)
    bent = np.degrees(np.arccos(np.clip(rays.direction @ to_sun, -1, 1)))
    assert (bent < 60).mean() > 0.85


@pytest.mark.parametrize("faces, is_double_sided, is_mirrored, lights", [
    ("down", False, False, 1), ("up", False, False, 0), ("up", True, False, 1), ("down", False, True, 1)])
def test_a_lamp_shines_from_its_front(faces, is_double_sided, is_mirrored, lights) -> None:
    """A small plate above a ball of glass: radiance times area over the square of the distance is the irradiance of the
    ball's disk. An instance that is mirrored shines as one that is not."""
    matrix = facing_floor() @ np.diag([-1.0 if is_mirrored else 1.0, 1, 1, 1])
    if faces == "down":
        matrix[:3, 1:3] *= -1
    matrix[:3, 3] = CENTER + (0, 2, 0)
    lamp = replace(LAMP, double_sided=is_double_sided)
    _, (caster,), rays = traced(beside_floor(GLASS, (lamp, matrix)))
    assert rays.flux.sum() == pytest.approx(lights * 0.89 * 60 * 0.4**2 / 2**2 * np.pi * caster.radius**2, rel=0.05)
