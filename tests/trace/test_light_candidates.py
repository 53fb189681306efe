"""The light sample of a hit, one of two candidates: the light of a plate below an uneven sky is the same as by BSDF
samples alone and by quadrature, that of a room with a lamp is the same as by BSDF samples alone, and both are less
noisy than with one candidate."""

from __future__ import annotations

import numpy as np
import pytest
from mutations import Mutation, planted
from pictures import picture
from shapes import WHITE, moved, orthographic, plate, scene

from viewer.gpu.context import Context
from viewer.scene.environment import Environment
from viewer.scene.equirect import texel_directions, texel_solid_angles
from viewer.scene.light import Light
from viewer.scene.material import Material
from viewer.settings import Settings
from viewer.trace.scene.traced_scene import plan_without_device
from viewer.trace.tracer import Tracer

SIZE = (40, 40)
MATERIALS = {
    "plastic": Material(metallic=0.0, perceptual_roughness=0.5, base_color=(0.3, 0.5, 0.8, 1)),
    "metal that covers in part": Material(metallic=1.0, perceptual_roughness=0.6, base_color=(0.9, 0.6, 0.3, 0.5),
                                          alpha_mode="blend"),  # the number that chooses decides on this first
    "sheen": Material(metallic=0.0, perceptual_roughness=0.8, base_color=(0.4, 0.1, 0.1, 1),
                      sheen_color=(0.8, 0.7, 0.9), sheen_roughness=0.4),
}


def uneven() -> Environment:
    """Dark, with a broad and a narrow light, of other colours, half of the narrow one below the plate's horizon."""
    d = texel_directions(32, 64)
    broad, narrow = ((d @ np.array(axis) / np.linalg.norm(axis)) for axis in ((0.5, 0.6, 0.8), (-1.0, 0.2, 0.1)))
    sky = 0.05 + np.where(broad > 0.9, 8.0, 0.0)[..., None] * [1.0, 0.8, 0.5]
    return Environment("uneven", (sky + np.where(narrow > 0.97, 20.0, 0.0)[..., None] * [0.3, 0.5, 1.0])
                       .astype(np.float32))


SKY = uneven()
VIEW = orthographic(0.3, 0.5, height=0.5)


def plate_of(material: Material):
    """It fills the picture, so that all its pixels are samples of one number."""
    return scene(plate(0, 4.0), materials=[material], environment=SKY)


def light(tracer: Tracer, material: Material, **settings: object) -> tuple[np.ndarray, np.ndarray]:
    """Of each channel the mean of all pixels and its standard error."""
    pixels = picture(tracer, plate_of(material), VIEW, SIZE, **settings)[..., :3].reshape(-1, 3)
    return pixels.mean(axis=0), pixels.std(axis=0) / np.sqrt(len(pixels))


@pytest.mark.parametrize("name", MATERIALS)
def test_it_is_the_light_of_surface_samples_alone(tracer, name):
    (both, error), (alone, noise) = (light(tracer, MATERIALS[name], spp=spp, sampling=sampling)
                                     for spp, sampling in ((128, "mis"), (1024, "bsdf")))
    error = np.hypot(error, noise)
    assert (error < 0.005 * alone).all()
    assert (np.abs(both - alone) < 4 * error).all()


def test_it_is_the_light_of_quadrature(tracer):
    """A matte plate's radiance is albedo times irradiance over pi, here by the midpoints of 2^21 cells in float64."""
    n = 1024
    d = texel_directions(n, 2 * n)
    height, width = SKY.radiance.shape[:2]
    y, x = ((np.arange(count) + 0.5) * of / count - 0.5 for count, of in ((n, height), (2 * n, width)))
    row, column = np.floor(y).astype(int), np.floor(x).astype(int)
    fy, fx = (y - row)[:, None, None], (x - column)[:, None]
    rows = SKY.radiance.astype(float)[np.clip(row, 0, height - 1)] * (1 - fy) + fy * SKY.radiance[
        np.clip(row + 1, 0, height - 1)]
    radiance = rows[:, column % width] * (1 - fx) + fx * rows[:, (column + 1) % width]
    weight = np.maximum(d[..., 2], 0) * texel_solid_angles(n, 2 * n)[:, None] / np.pi
    mean, error = light(tracer, WHITE, spp=64)
    assert (error < 0.002 * mean).all()
    assert (np.abs(mean - (radiance * weight[..., None]).sum(axis=(0, 1))) < 4 * error + 5e-4 * mean).all()


ONE = Mutation("one candidate", "trace/shade.glsl", "p.depth == 0 ? FIRST_CANDIDATES : LATER_CANDIDATES", "1")
ONE_LATER = Mutation("one candidate later", "trace/shade.glsl", "p.depth == 0 ? FIRST_CANDIDATES : LATER_CANDIDATES",
                     "p.depth == 0 ? 2 : 1")


def test_two_are_less_noisy_than_one(tracer, context: Context):
    with planted(ONE):
        single = Tracer(context, use_cache=False)
        one = light(single, MATERIALS["plastic"], spp=16)[1][1]
        single.release()
    two = light(tracer, MATERIALS["plastic"], spp=16)[1][1]
    assert two < 0.95 * one  # of green, which is most of what they are chosen by


def room():
    """A floor that the camera looks at, which a wall lights alone: its lamp stands close to the wall, and faces it."""
    to_wall, from_wall = moved((0, -0.7, 1.2)), moved((0, -1, 2))
    to_wall[:3, :3] = np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]])
    from_wall[:3, :3] = np.array([[1, 0, 0], [0, 0, 1], [0, -1, 0]])
    lamp = Material("lamp", emissive=(20.0, 20.0, 20.0), base_color=(0, 0, 0, 1))
    return scene(plate(0, 4.0), (plate(0, 2.0), from_wall), (plate(1, 0.5), to_wall), materials=[WHITE, lamp])


def test_two_serve_at_later_hits_of_a_room(tracer, context: Context):
    """The mean is that of surface samples alone, and the noise, between two pictures, less than with one."""
    def pictures(by: Tracer, **settings: object) -> np.ndarray:
        return np.array([picture(by, room(), VIEW, SIZE, seed=seed, bounces=2, **settings)[..., 0] for seed in (0, 1)])

    def noise(both: np.ndarray) -> float:
        return float(np.sqrt(np.mean((both[1] - both[0]) ** 2) / 2))

    two, alone = pictures(tracer, spp=64), pictures(tracer, spp=1024, sampling="bsdf")
    error = np.hypot(noise(two), noise(alone)) / np.sqrt(two.size)
    assert error < 0.01 * alone.mean() and abs(two.mean() - alone.mean()) < 4 * error
    with planted(ONE_LATER):
        single = Tracer(context, use_cache=False)
        one = pictures(single, spp=64)
        single.release()
    assert noise(two) < 0.95 * noise(one)


@pytest.mark.parametrize("lamps, sky, has_glass, counts", [
    (1, None, False, (2, 2)), (4, None, False, (2, 2)), (5, None, False, (1, 1)), (0, None, False, (1, 1)),
    (1, SKY, False, (2, 1)), (0, SKY, False, (2, 1)), (1, None, True, (1, 1)), (1, SKY, True, (1, 1))])
def test_where_there_are_two(lamps, sky, has_glass, counts):
    """In rooms with up to eight emissive triangles at all hits, under an environment at the first, and nowhere beside
    glass."""
    glass = Material("glass", metallic=0.0, transmission=1.0, thickness=1.0)
    lamp = Material("lamp", emissive=(2.0, 2.0, 2.0))
    model = scene(plate(0), *[(plate(1, 0.1), moved((k, 0, 1))) for k in range(lamps)],
                  *[(plate(2), moved((0, 1, 0)))] * has_glass, materials=[WHITE, lamp, glass], environment=sky,
                  lights=(Light("point", position=(0.0, 0.0, 2.0)),))
    programs = plan_without_device(model, Settings(mode="path")).programs.values()
    shading = [dict(program.switches) for program in programs if "LATER_CANDIDATES" in dict(program.switches)]
    assert {(each["FIRST_CANDIDATES"], each["LATER_CANDIDATES"]) for each in shading} == {counts}


def test_they_follow_the_light_and_not_the_scene_before(tracer):
    """A room that an environment lights, and then its lamp alone."""
    lit = room().relit(environment=SKY, lights=())
    for model, later in ((lit, 1), (lit.relit(environment=None, lights=()), 2)):
        render = tracer.begin(model, VIEW, Settings(mode="path"), SIZE)
        shading = [program for program in render.plan.programs.values() if "LATER_CANDIDATES" in dict(program.switches)]
        assert shading and all(program["LATER_CANDIDATES"] == later for program in shading)
        render.release()
