"""White media of any depth: paths take long steps in them, end, and bring all their light."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from pictures import halves, picture
from shapes import WHITE, constant, moved, scene, sphere
from slab import slab_light
from test_scattering import albedo_of, box, fog

from viewer.scene.camera import Camera
from viewer.scene.environment import Environment
from viewer.scene.light import Light
from viewer.scene.medium import Medium
from viewer.scene.phase import spectrum
from viewer.scene.volume import Volume
from viewer.settings import Settings
from viewer.trace import defines
from viewer.trace.scene.deep_media import decay, first_step
from viewer.trace.scene.traced_scene import plan_without_device

INSIDE = replace(Camera.orbit((0, 0, 0), 2.0, 0.3, 0.2), fov_y=1.0)
SAMPLES = 12
SPECKS = (sphere(segments=8), moved((0, -0.9, 0), 1e-4)), (sphere(segments=8), moved((0, 0.9, 0), 1e-4))
"""What gives a scene its size and hardly meets any light."""


@pytest.mark.parametrize("albedo", [0.5, 0.9, 0.999])
def test_the_decay_of_evenly_scattered_light(albedo):
    """albedo atanh(kappa) = kappa                                                    (Case and Zweifel 1967)"""
    kappa = decay(albedo, spectrum(Medium(), 128))
    assert albedo * np.arctanh(kappa) == pytest.approx(kappa, rel=1e-6)


@pytest.mark.parametrize("g", [0.0, 0.6, -0.5])
def test_the_first_step_has_the_moments_of_a_walk(g):
    """Where paths of Henyey and Greenstein's phase function that begin along z come to, on average, in float64."""
    rng = np.random.default_rng(4)
    direction, place = np.tile([0.0, 0.0, 1.0], (100_000, 1)), np.zeros((100_000, 3))
    for _ in range(30 if g > 0 else 10):
        place += rng.exponential(size=(len(place), 1)) * direction
        s = 2 * rng.random(len(place)) - 1
        cosine = (1 + g * g - ((1 - g * g) / (1 + g * s)) ** 2) / (2 * g) if g else s
        side = np.cross(direction, rng.normal(size=place.shape))
        side /= np.linalg.norm(side, axis=1, keepdims=True)
        direction = cosine[:, None] * direction + np.sqrt(1 - cosine**2)[:, None] * side
    mean, half = first_step(1.0, spectrum(Medium(g=g), 128))
    quadrupole = (place[:, 2] ** 2 - (place[:, 0] ** 2 + place[:, 1] ** 2) / 2).mean()
    assert mean == pytest.approx(place[:, 2].mean(), rel=0.02)
    assert mean**2 + half**2 / 3 == pytest.approx(quadrupole, rel=0.06)


@pytest.mark.parametrize("depth, g", [(170, 0.0), (1e3, 0.7), (1e6, 0.0)])
def test_white_fog_keeps_all_light(tracer, depth, g):
    """A furnace: no path is lost, however dense the fog is."""
    model = scene(*SPECKS, materials=[WHITE], environment=constant())
    pixels = picture(tracer, model, INSIDE, (8, 8), spp=4, sampling="bsdf", bounces=255,
                     fog=depth / 4 / model.radius, fog_g=g)
    assert pixels[..., :3] == pytest.approx(1, abs=1e-6)


def test_white_fog_returns_the_sun(tracer):
    """Seen from the sun, in the middle of a ball of fog: E / (8 pi) H(1)^2 with H(1) = 2.9078 (Chandrasekhar 1960),
    less what leaves on the far side, about 1 / depth of it."""
    model = scene(*SPECKS, materials=[WHITE], lights=(Light("directional", intensity=1.0, direction=(0, 0, -1)),))
    reach = 4 * model.radius
    camera = Camera.look_at((0, 0, 100 * reach), (0, 0, 0), fov_y=1e-3)
    found = halves(tracer, model, camera, (16, 16), spp=2 * SAMPLES, fog=1000 / reach).mean.mean()
    assert found == pytest.approx(2.9078**2 / (8 * np.pi), rel=0.03)


@pytest.mark.parametrize("color, g", [(1.0, 0.0), (0.96, 0.6)])
def test_light_deep_in_a_slab(tracer, color, g):
    """A quarter of the way into a slab that is lit from above, seen sideways; against discrete ordinates in float64."""
    tau, material = 60.0, fog(60.0, color, g)
    sky = np.zeros((256, 4, 3), np.float32)
    sky[:128] = 1.0
    model = scene(box((4.0, 0.5, 4.0)), materials=[material], environment=Environment("sky", sky))
    expected = slab_light(tau, albedo_of(material), g, 1.0, 0.0).source(0.75 * tau, 0.0)
    camera = Camera.look_at((0, 0.25, 0), (0, 0.25, -1), fov_y=1e-3)
    found = halves(tracer, model, camera, (16, 16), spp=SAMPLES)
    bound = 4 * np.sqrt(expected * (1 - expected) / (256 * SAMPLES))
    assert found.mean.mean() == pytest.approx(expected, abs=bound)


def test_white_volumes_keep_all_light(tracer, monkeypatch):
    """A cube of a white volume, 1000 mean free paths wide, in a furnace, seen from its middle."""
    monkeypatch.setitem(defines._CONSTANTS, "THINS_FROM", 256)
    monkeypatch.setitem(defines._CONSTANTS, "THINS_EVERY", 64)
    cube = Volume.in_box(np.ones((8, 8, 8), np.float32), [[-0.5] * 3, [0.5] * 3])
    model = replace(scene(*SPECKS, materials=[WHITE]), volumes=(cube,)).relit(environment=constant(), lights=())
    camera = Camera.look_at((0.01, 0.01, 0.01), (0, 0, -1), fov_y=0.1)
    pixels = picture(tracer, model, camera, (4, 4), spp=2, sampling="bsdf", volume_density=1000.0,
                     volume_albedo=(1.0, 1.0, 1.0))
    assert pixels[..., :3] == pytest.approx(1, abs=1e-6)


def test_only_deep_white_media_have_its_code():
    model = scene(*SPECKS, materials=[WHITE], environment=constant())
    for settings, expected in (({"fog": 100.0}, 1), ({"fog": 1.0}, 0), ({"fog": 100.0, "fog_albedo": (0.9,) * 3}, 0)):
        plan = plan_without_device(model, Settings.of(mode="path", **settings))
        assert plan.programs["medium"]["HAS_DEEP_MEDIA"] == expected
