"""What the split sum's pieces call the renderer's way is what it draws."""

from __future__ import annotations

import numpy as np
import pytest
from shapes import orthographic, scene, sphere

from benchmarks.approximations import split_sum
from viewer.raster.renderer import Renderer
from viewer.scene.environment_presets import make_preset
from viewer.scene.material import Material
from viewer.settings import Settings

SIZE, HEIGHT, ROUGHNESS = 48, 2.2, 0.4


@pytest.mark.parametrize(("metallic", "f0", "make"), [(1.0, 0.9, split_sum.metal_piece),
                                                     (0.0, 0.04, split_sum.dielectric_piece)])
def test_reflection(context, device, metallic, f0, make):
    camera = orthographic(0.8, 0.3, height=HEIGHT)
    material = Material(base_color=(f0, f0, f0, 1.0), metallic=metallic, perceptual_roughness=ROUGHNESS)
    model = scene(sphere(segments=192), materials=[material], environment=make_preset("studio"))
    settings = Settings.of(lobes="specular", background="none", specular_aa="off", antialias="none")
    renderer = Renderer(context, use_cache=False)
    picture = renderer.render(model, camera, settings, (SIZE, SIZE)).linear[..., :3]
    renderer.release()

    x, y = (np.mgrid[0:SIZE, 0:SIZE][::-1] + 0.5) / SIZE * HEIGHT * np.array([1, -1])[:, None, None]
    x, y = x - HEIGHT / 2, y + HEIGHT / 2
    inside = x**2 + y**2 < 0.97
    n = np.stack([x, y, np.sqrt(np.maximum(1 - x**2 - y**2, 0))], axis=-1) @ camera.pose[:3, :3].T
    parameters = np.empty((SIZE, SIZE, 8), np.float32)
    parameters[..., :3], parameters[..., 3] = n, ROUGHNESS
    parameters[..., 4:7], parameters[..., 7] = -camera.forward, f0
    off = {}
    for variant in make().variants:
        found = device.values(variant.kernels[0], parameters)[..., :3]
        off[variant.is_default, variant.name] = np.abs(picture / np.maximum(found, 1e-6) - 1)[inside].max()
    assert min(off, key=off.__getitem__)[0] and min(off.values()) < 0.02
    assert sorted(off.values())[1] > 0.1, off
