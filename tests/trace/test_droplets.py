"""The phase function of droplets in path-traced pictures of volumes and fog."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from media_twins import droplet_phase
from pictures import picture
from shapes import WHITE, constant, moved, orthographic, scene, sphere

from viewer.raster.renderer import Renderer
from viewer.scene.light import Light
from viewer.scene.scene import Scene
from viewer.scene.volume import Volume
from viewer.settings import Settings
from viewer.trace.scene.traced_scene import plan_without_device

ALONG_Z = orthographic(0.0, 0.0, height=0.2)
CUBE = Volume.in_box(np.ones((2, 2, 2), np.float32), np.array([[-0.5] * 3, [0.5] * 3]))


def lit(kind: str, angle: float) -> Scene:
    """A sun whose light is turned by this angle on its way to the eye, and a volume or nothing but a ball far aside."""
    light = Light("directional", intensity=1.0, direction=(np.sin(angle), 0.0, np.cos(angle)))
    if kind == "volume":
        return Scene("volume", (), (), (), lights=(light,), volumes=(CUBE,))
    black = replace(WHITE, base_color=(0, 0, 0, 1))
    return scene((sphere(segments=8), moved((0, 1, 0), 0.01)), (sphere(segments=8), moved((0, -1, 0), 0.01)),
                 materials=[black], lights=(light,))


@pytest.mark.parametrize("kind", ["volume", "fog"])
@pytest.mark.parametrize("mode", ["pbr", "path"])
def test_light_scattered_once_follows_the_phase_function(context, tracer, kind, mode):
    """The same picture with isotropic scattering has 1 / 4 pi in its place; nothing is scattered twice that counts."""
    thin = {"volume_density" if kind == "volume" else "fog": 0.01}
    renderer = Renderer(context)
    for angle in (0.05, 0.6, 2.5, np.pi):
        means = []
        for diameter in (0.0, 12.0):
            settings = thin | {f"{kind}_droplets": diameter}
            if mode == "path":
                pixels = picture(tracer, lit(kind, angle), ALONG_Z, (8, 8), spp=16, **settings)
            else:
                pixels = renderer.render(lit(kind, angle), ALONG_Z, Settings.of(
                    background="none", media_scattering="single", **settings), (8, 8)).linear
            means.append(pixels[..., :3].mean())
        even, droplets = means
        assert even > 0
        assert droplets / even == pytest.approx(4 * np.pi * droplet_phase(12.0, 1 - np.cos(angle)), rel=0.02)
    renderer.release()


def test_white_droplets_vanish_in_the_furnace(tracer):
    model = Scene("volume", (), (), (), environment=constant(), volumes=(CUBE,))
    pixels = picture(tracer, model, ALONG_Z, (8, 8), spp=64, volume_density=4.0, volume_albedo=(1, 1, 1),
                  volume_droplets=20.0)
    assert pixels[..., :3].mean() == pytest.approx(1, abs=0.012)


def test_only_programs_for_droplets_know_them():
    model = lit("volume", 1.0)
    for settings, there in (({}, 0), ({"volume_droplets": 8.0}, 1), ({"fog_droplets": 8.0}, 0),
                            ({"fog_droplets": 8.0, "fog": 1.0}, 1)):
        plan = plan_without_device(model, Settings.of(mode="path", **settings))
        assert plan.programs["medium"]["HAS_DROPLETS"] == there
        assert ("droplets of water" in plan.used) == bool(there)
