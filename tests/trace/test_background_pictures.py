"""The environment behind a scene, which both renderers show alike: smooth where it is magnified, and blurred."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from shapes import WHITE, orthographic, plate, scene
from splines import bspline

import viewer
from viewer.bake.background import blurred
from viewer.gpu.context import open_context
from viewer.scene.camera import Camera
from viewer.scene.environment import Environment
from viewer.scene.scene import Scene
from viewer.settings import Settings
from viewer.trace.defines import shader_defines
from viewer.trace.tracer import Tracer

SIZE = (48, 40)
MODES = {"pbr": {"antialias": "none"}, "path": {"spp": 64}}


def map_of(height: int) -> Environment:
    """Random texels, which show every difference of filtering."""
    texels = np.random.default_rng(height).random((height, 2 * height, 3)).astype(np.float32)
    return Environment("noise", texels, rotation=0.7, intensity=1.5)


def seen(environment: Environment, texels: np.ndarray, camera: Camera) -> np.ndarray:
    """Radiance of the pixels' centres, (H, W, 3), by B-splines of `texels`."""
    width, height = SIZE
    x = (2 * (np.arange(width) + 0.5) / width - 1) * np.tan(camera.fov_y / 2) * width / height
    y = (1 - 2 * (np.arange(height) + 0.5) / height) * np.tan(camera.fov_y / 2)
    d = camera.forward + x[None, :, None] * camera.pose[:3, 0] + y[:, None, None] * camera.pose[:3, 1]
    d /= np.linalg.norm(d, axis=-1, keepdims=True)
    c, s = np.cos(environment.rotation), np.sin(environment.rotation)
    u = 0.5 + np.arctan2(s * d[..., 0] + c * d[..., 2], c * d[..., 0] - s * d[..., 2]) / (2 * np.pi)
    uv = np.stack([u, np.arccos(np.clip(d[..., 1], -1, 1)) / np.pi], axis=-1).reshape(-1, 2)
    return (bspline(texels, uv) * environment.intensity).reshape(height, width, 3)


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("elevation", [0.0, 0.9])
def test_a_magnified_map_is_smooth(mode, elevation):
    """Texels of 11 degrees over pixels of one; a bilinear look-up differs by a fifth of the contrast."""
    environment, camera = map_of(16), Camera.orbit((0, 0, 0), 3.0, 0.4, elevation)
    picture = viewer.render(Scene("empty", environment=environment), SIZE, camera, mode=mode, **MODES[mode])
    expected = seen(environment, environment.radiance, camera)
    assert np.abs(picture.linear[..., :3] - expected).max() < (0.01 if mode == "pbr" else 0.03)


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("degrees", [4.0, 30.0])
def test_the_background_is_blurred_and_nothing_else(mode, degrees):
    environment, camera = map_of(128), Camera.orbit((0, 0, 0), 3.0, 2.0, 0.2)
    blur = MODES[mode] | {"mode": mode, "background_blur": degrees}
    picture = viewer.render(Scene("empty", environment=environment), SIZE, camera, **blur)
    expected = seen(environment, blurred(environment.radiance, degrees), camera)
    assert np.abs(picture.linear[..., :3] - expected).max() < 0.01
    wall = scene(plate(half=9.0), materials=[WHITE], environment=environment)
    sharp, soft = (viewer.render(wall, SIZE, orthographic(0, 0, height=1.0), **blur | {"background_blur": amount})
                   for amount in (0.0, degrees))
    assert np.array_equal(sharp.linear, soft.linear)


def test_where_buffers_are_small_the_blur_is_wider(monkeypatch):
    """OpenGL 3.3 grants 65536 texels, in which maps of 128 rows fit. These resolve a blur of two degrees."""
    monkeypatch.setattr("viewer.gpu.smooth_map.most_texels", lambda context: 1 << 16)
    environment, camera = map_of(128), Camera.orbit((0, 0, 0), 3.0, 2.0, 0.2)
    picture = viewer.render(Scene("empty", environment=environment), SIZE, camera, mode="path", background_blur=0.5,
                            **MODES["path"])
    texels = blurred(environment.radiance, 0.5, 128)
    assert texels.shape == (128, 256, 3)
    assert np.abs(picture.linear[..., :3] - seen(environment, texels, camera)).max() < 0.01


def test_programs_have_b_splines_only_where_the_background_needs_them():
    """A map of texels as fine as pixels is looked up once, and a background that is not seen not at all."""
    empty, camera = Scene("empty", environment=map_of(16)), Camera.orbit((0, 0, 0), 3.0, 2.0, 0.2)
    fine = replace(empty, environment=map_of(256))
    with open_context() as context:
        tracer = Tracer(context)
        for shown, changes, expected in ((empty, {}, 2), (fine, {}, 1), (fine, {"background_blur": 2.0}, 2),
                                         (empty, {"background": "none", "background_blur": 2.0}, 0)):
            render = tracer.begin(shown, camera, Settings(mode="path", spp=1, **changes), SIZE)
            program, switches = render.plan.programs["finish"], dict(render.plan.programs["finish"].switches)
            assert switches["BACKGROUND"] == expected
            made = tracer.programs.get("trace/path_class.vert", program.fragment, shader_defines(switches))
            assert ("u_background" in made) == (expected == 2)
            render.release()
        tracer.release()
