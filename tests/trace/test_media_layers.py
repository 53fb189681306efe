"""Layers of pictures of media, and what denoising makes of them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from shapes import WHITE, constant, moved, orthographic, plate, scene

from viewer.scene.fog import REACH
from viewer.scene.light import Light
from viewer.scene.scene import Scene
from viewer.scene.volume import Volume
from viewer.settings import Settings

ALONG_Z = orthographic(0.0, 0.0, height=0.8)
LAYERS = ("albedo", "normal", "distance")


def slab() -> Scene:
    """A length of 1 of density 1, from z = -0.5 on."""
    volume = Volume.in_box(np.ones((2, 2, 2), np.float32), np.array([[-2, -2, -0.5], [2, 2, 0.5]]))
    return Scene("slab", (), (), (), environment=constant(), volumes=(volume,))


def layers(tracer, model: Scene, **settings: object) -> dict[str, np.ndarray]:
    return tracer.render(model, ALONG_Z, Settings.of(mode="path", **settings), (16, 16), LAYERS).layers


def mean_collision(sigma: float, way: float) -> float:
    """Of collisions before `way`: the integral of t sigma exp(-sigma t) over that of its density."""
    return 1 / sigma - way * np.exp(-sigma * way) / -np.expm1(-sigma * way)


def test_a_volume_has_its_albedo_and_the_mean_distance_of_its_collisions(tracer):
    found = layers(tracer, slab(), spp=128, volume_density=2.0, volume_albedo=(0.9, 0.6, 0.3))
    assert found["albedo"].mean(axis=(0, 1)) == pytest.approx((0.9, 0.6, 0.3), abs=1e-5)
    assert (found["normal"] == 0).all()
    front = ALONG_Z.eye[2] - 0.5
    assert found["distance"].mean() == pytest.approx(front + mean_collision(2.0, 1.0), abs=0.005)


def test_fog_has_them_where_no_surface_is(tracer):
    """And where one is, the layers are those of the surface: what is before it is no edge."""
    model = scene((plate(0, half=0.2), moved((0.2, 0, 0))), (plate(0, half=0.01), moved((0, 0, 0.9))),
                  (plate(0, half=0.01), moved((0, 0, -0.9))), materials=[WHITE], environment=constant())
    found = layers(tracer, model, spp=128, fog=0.3, fog_albedo=(0.9, 0.6, 0.3))
    empty, plain = np.s_[4:12, 1:6], np.s_[6:10, 9:14]
    assert found["albedo"][empty].mean(axis=(0, 1)) == pytest.approx((0.9, 0.6, 0.3), abs=1e-5)
    radius = REACH * model.radius
    front = ALONG_Z.eye[2] - radius
    assert found["distance"][empty].mean() == pytest.approx(front + mean_collision(0.3, 2 * radius), rel=0.02)
    assert found["distance"][plain] == pytest.approx(ALONG_Z.eye[2], abs=1e-3)
    assert found["normal"][plain][..., 2] == pytest.approx(1, abs=1e-5)


def test_nothing_is_recorded_where_nothing_collides(tracer):
    found = layers(tracer, slab(), spp=4, volume_density=0.0)
    assert (found["albedo"] == 0).all() and np.isinf(found["distance"]).all()


@pytest.mark.parametrize("medium", [{"volume_density": 2.0}, {"fog": 0.4}], ids=str)
def test_denoising_lowers_the_error_of_media(tracer, medium):
    """In a cloud that is denser in its middle, thin or thick, and in fog, under a light from one side."""
    z, y, x = np.mgrid[-1:1:8j, -1:1:8j, -1:1:8j]
    ball = Volume.in_box(np.float32(np.maximum(1 - np.sqrt(x * x + y * y + z * z), 0)), np.array([[-1] * 3, [1] * 3]))
    model = Scene("ball", (), (), (), environment=constant(0.3), volumes=() if "fog" in medium else (ball,),
                  lights=(Light("directional", intensity=3.0, direction=(0.8, -0.6, 0.0)),))
    if "fog" in medium:
        model = replace(scene((plate(0, half=0.4), moved((0, 0, 0))), materials=[WHITE]), environment=model.environment,
                        lights=model.lights)
    camera = orthographic(0.3, 0.2, height=1.6)

    def picture(spp: int, denoise: str, seed: int = 0) -> np.ndarray:
        settings = Settings.of(mode="path", spp=spp, denoise=denoise, seed=seed, **medium)
        return tracer.render(model, camera, settings, (16, 16)).linear[..., :3].astype(float)

    truth = picture(256, "off")
    raw, denoised = (np.array([picture(8, denoise, seed) for seed in range(1, 11)]) for denoise in ("off", "fast"))
    before, after = (np.sqrt(((p - truth) ** 2 / (truth**2 + 0.01)).mean()) for p in (raw, denoised))
    assert after < 0.7 * before
    # The means of one picture differ by 8e-3 (one standard deviation), by chance.
    assert denoised.mean() == pytest.approx(raw.mean(), rel=4e-3)
