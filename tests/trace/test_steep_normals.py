"""Normal maps whose normals are steep: the formula of glTF, and where both renderers depart from it."""

from __future__ import annotations

import numpy as np
import pytest
from images import image_of
from shapes import orthographic, plate, scene

from viewer.raster.renderer import Renderer
from viewer.scene.light import Light
from viewer.scene.material import Material, Texture
from viewer.settings import Settings

TEXEL = np.array([178, 128, 230], np.uint8)


@pytest.mark.parametrize("scale", [0.5, 1.0, 2.0, 4.0])
def test_the_scale_of_a_normal_map(tracer, scale):
    """A matte plate that faces the eye and a light of irradiance pi has the radiance n.l.

    From a slope of 45 degrees on, the mirrored ray would enter the plate. There the normal is bent back, until the ray
    is 0.01 above it.
    """
    normal = (2 * (TEXEL / 255.0) - 1) * (scale, scale, 1)
    expected = max(normal[2] / np.linalg.norm(normal), np.sqrt((1 + 0.01) / 2))
    material = Material(metallic=0.0, specular=0.0, perceptual_roughness=1.0, normal_scale=scale,
                        normal_texture=Texture(image_of(np.tile(TEXEL, (4, 4, 1)))))
    model = scene(plate(), materials=[material], lights=(Light("directional", intensity=np.pi, direction=(0, 0, -1)),))
    camera = orthographic(height=1.0)
    renderer = Renderer(tracer.context)
    raster = renderer.render(model, camera, Settings.of(background="none"), (8, 8)).linear[4, 4, 0]
    renderer.release()
    path = tracer.render(model, camera, Settings.of(mode="path", spp=4, bounces=1, background="none"),
                         (8, 8)).linear[4, 4, 0]
    assert raster == pytest.approx(expected, abs=1e-4)
    assert path == pytest.approx(expected, abs=0.005)
