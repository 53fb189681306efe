from __future__ import annotations

import numpy as np
import pytest
from needs import CORPUS, needs

from viewer.bake.sun import extract_sun
from viewer.scene.environment import Environment
from viewer.scene.environment_files import load_environment
from viewer.scene.equirect import sphere_integral, texel_directions

ENVIRONMENTS = CORPUS / "environments"


def flux(lights) -> np.ndarray:
    return sum((np.array(light.color) * light.intensity for light in lights), np.zeros(3))


def disk(direction, radius_degrees: float, radiance: float, size=(512, 1024)) -> Environment:
    direction = np.array(direction) / np.linalg.norm(direction)
    pixels = np.full((*size, 3), 0.5, np.float32)
    pixels[texel_directions(*size) @ direction > np.cos(np.radians(radius_degrees))] = radiance
    return Environment("test", pixels)


@pytest.mark.parametrize("direction", [(0.3, 0.5, -0.8), (0, 1, 0.001), (-1, 0.1, 0), (-1, 0.2, -1e-4)])
def test_a_sun_becomes_a_light_from_where_it_stands(direction):
    environment = disk(direction, 0.7, 2e4)
    rest, [light] = extract_sun(environment)
    towards = -np.array(light.direction)
    assert np.degrees(np.arccos(towards @ direction / np.linalg.norm(direction))) < 0.2
    assert light.kind == "directional"
    assert np.degrees(light.angular_radius) == pytest.approx(0.7, rel=0.08)  # of texels of 0.35
    assert rest.radiance.max() == 0.5
    assert sphere_integral(rest.radiance) + flux([light]) == pytest.approx(sphere_integral(environment.radiance), 1e-6)
    assert environment.radiance.max() == 2e4  # the original is left as it was: the background shows the sun


def test_two_suns():
    pixels = np.maximum(disk((1, 1, 0), 0.7, 2e4).radiance, disk((-1, 1, 0), 0.7, 1e4).radiance)
    rest, lights = extract_sun(Environment("tatooine", pixels))
    assert [light.direction[0] < 0 for light in lights] == [True, False]  # the brighter one, at +x, first
    assert sphere_integral(rest.radiance) + flux(lights) == pytest.approx(sphere_integral(pixels), rel=1e-6)


@pytest.mark.parametrize(
    "environment",
    [
        disk((0, 1, 1), 15, 100),  # a soft box
        disk((0, 1, 1), 4, 1e4),  # a lamp near by
        disk((0, 1, 1), 0.7, 50),  # too weak to matter
        disk((0, 1, 1), 0.7, 0.5),  # nothing at all
        disk((0, 1, 1), 12, 1e5, (16, 32)),  # a texel that is larger than any sun
        Environment("black", np.zeros((512, 1024, 3), np.float32)),
    ],
)
def test_what_is_no_sun_stays(environment):
    rest, lights = extract_sun(environment)
    assert not lights
    assert rest is environment


@needs("corpus")
@pytest.mark.parametrize(
    ("name", "suns"),
    [
        ("noon_grass", 1), ("qwantani_afternoon_puresky", 1), ("chinese_garden", 1), ("st_peters_square_night", 0),
        ("lightroom_14b_from_ktx", 0), ("studio_small_05", 0), ("aircraft_workshop_01", 0), ("lebombo", 0),
    ],
)  # fmt: skip
def test_real_environments(name, suns):
    path = ENVIRONMENTS / f"{name}_1k.hdr"
    environment = load_environment(path)
    rest, lights = extract_sun(environment)
    assert len(lights) == suns
    assert sphere_integral(rest.radiance) + flux(lights) == pytest.approx(sphere_integral(environment.radiance), 1e-5)
    if suns:
        assert rest.radiance.max() < 65504
