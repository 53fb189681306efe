"""White media of any depth: paths take long steps in them, end, and bring all their light."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from pictures import picture
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
from viewer.trace.scene.deep_media import MARGIN, decay, deep_media, first_step
from viewer.trace.scene.geometry import trace_geometry
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
    found = picture(tracer, model, camera, (16, 16), spp=2 * SAMPLES, fog=1000 / reach)[..., :3].mean()
    assert found == pytest.approx(2.9078**2 / (8 * np.pi), rel=0.03)


@pytest.mark.parametrize("tau, color, g", [(60.0, 1.0, 0.0), (120.0, 0.96, 0.6)])
def test_light_deep_in_a_slab(tracer, tau, color, g):
    """A quarter of the way into a slab that is lit from above, seen sideways; against discrete ordinates in float64.
    Where light goes on, that is twice as far as its long steps stay from the surface."""
    material = fog(tau, color, g)
    sky = np.zeros((256, 4, 3), np.float32)
    sky[:128] = 1.0
    model = scene(box((4.0, 0.5, 4.0)), materials=[material], environment=Environment("sky", sky))
    expected = slab_light(tau, albedo_of(material), g, 1.0, 0.0).source(0.75 * tau, 0.0)
    camera = Camera.look_at((0, 0.25, 0), (0, 0.25, -1), fov_y=1e-3)
    found = picture(tracer, model, camera, (16, 16), spp=SAMPLES)[..., :3]
    bound = 4 * np.sqrt(expected * (1 - expected) / (256 * SAMPLES))
    assert found.mean() == pytest.approx(expected, abs=bound)


@pytest.fixture
def short_walks(monkeypatch):
    """The mean free path grows early, so that tests are quick."""
    for name, value in (("THINS_FROM", 256), ("THINS_EVERY", 64), ("HURRIES_FROM", 600), ("HURRIES_EVERY", 8),
                        ("MOST_STEPS", 1000)):
        monkeypatch.setitem(defines._CONSTANTS, name, value)


def inside_of_volume(tracer, half_sizes, spp: int, **settings: object) -> np.ndarray:
    """Seen from near the middle of a box of smoke in a furnace."""
    box = Volume.in_box(np.ones((8, 8, 8), np.float32), [-np.array(half_sizes), half_sizes])
    model = replace(scene(*SPECKS, materials=[WHITE]), volumes=(box,)).relit(environment=constant(), lights=())
    camera = Camera.look_at((0.01, 0.01, 0.0), (0, 0, -1), fov_y=0.1)
    return picture(tracer, model, camera, (4, 4), spp=spp, sampling="bsdf", **settings)[..., :3]


@pytest.mark.parametrize("density", [1e3, 1e12])
def test_white_volumes_keep_all_light(tracer, short_walks, density):
    """Cubes of any optical depth."""
    pixels = inside_of_volume(tracer, (0.5, 0.5, 0.5), 2, volume_density=density, volume_albedo=(1.0, 1.0, 1.0))
    assert pixels == pytest.approx(1, abs=1e-6)


def test_volumes_that_absorb_next_to_nothing_are_dark_inside(tracer, short_walks):
    """A slab 100 mean free paths thick: 1 / cosh(kappa h) for light that decays as exp(-kappa x), and that is 1 at 0.71
    mean free paths outside of the slab. In ten times as dense a slab no light gets so far."""
    albedo = 0.9995
    kappa = decay(albedo, spectrum(Medium(), 128))
    expected, spp = 1 / np.cosh(kappa * (50 + 0.71)), 24
    found = inside_of_volume(tracer, (4.0, 4.0, 0.5), spp, volume_density=100.0, volume_albedo=(albedo,) * 3).mean()
    assert found == pytest.approx(expected, abs=4 * np.sqrt(expected * (1 - expected) / (16 * spp)))
    assert inside_of_volume(tracer, (4.0, 4.0, 0.5), 2, volume_density=1e3, volume_albedo=(albedo,) * 3).max() < 1e-3


def test_all_that_deep_volumes_emit_comes_together(tracer, short_walks):
    """In the middle of a white slab that emits q per mean free path: 3/2 q h^2, from 0.71 mean free paths outside. Mean
    free paths that grow so early reach farther outside. If each collision counted once, a tenth would come of it."""
    expected, spp = 1.5 * (50 + 0.71) ** 2, 24
    found = inside_of_volume(tracer, (4.0, 4.0, 0.5), spp, volume_density=100.0, volume_albedo=(1.0, 1.0, 1.0),
                             volume_emission=(100.0, 100.0, 100.0)).mean()
    assert found == pytest.approx(expected, rel=0.6)


def test_only_deep_white_media_have_its_code():
    model = scene(*SPECKS, materials=[WHITE], environment=constant())
    for settings, expected in (({"fog": 100.0}, 1), ({"fog": 1.0}, 0), ({"fog": 100.0, "fog_albedo": (0.9,) * 3}, 0)):
        plan = plan_without_device(model, Settings.of(mode="path", **settings))
        assert plan.programs["medium"]["HAS_DEEP_MEDIA"] == expected


@pytest.mark.parametrize("g, way", [(0.0, 1.0), (0.6, 2.5), (-0.5, 1.0)])
def test_long_steps_stay_as_far_away_as_light_goes_on(g, way):
    """A mean free path, or the transport mean free path 1 / (1 - g)."""
    geometry = trace_geometry(scene(box((1.0, 1.0, 1.0)), materials=[fog(100.0, 1.0, g)]))
    (record,) = deep_media(geometry).values()
    assert record[0, 3] == pytest.approx(MARGIN * way / (100 * geometry.unit), rel=1e-5)


@pytest.mark.parametrize("g, is_deep", [(0.0, True), (0.6, False)])
def test_channels_that_go_on_apart_take_no_long_steps(g, is_deep):
    """One first step is for all channels, and where light is scattered evenly there is none."""
    model = scene(box((1.0, 1.0, 1.0)), materials=[fog((100.0, 200.0, 100.0), 1.0, g)])
    assert bool(deep_media(trace_geometry(model))) == is_deep
