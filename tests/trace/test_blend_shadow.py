"""The shadow of a blended pane is a random decision for each ray, and has the right mean."""

from __future__ import annotations

import numpy as np
import pytest
from shapes import WHITE, facing_floor, plate, scene

from viewer.scene.camera import Camera
from viewer.scene.light import Light
from viewer.scene.material import Material
from viewer.settings import Settings


@pytest.mark.parametrize("light", [
    Light("directional", intensity=np.pi, direction=(0, -1, 0)),
    Light("point", intensity=np.pi * 100, position=(0, 10, 0)),
], ids=lambda light: light.kind)
@pytest.mark.parametrize("alpha", [0.2, 0.8])
def test_a_blended_pane_lets_through_what_it_does_not_cover(tracer, light, alpha):
    """A black pane hangs above a white floor, on which the light has the irradiance pi."""
    pane = Material(base_color=(0, 0, 0, alpha), metallic=0.0, specular=0.0, alpha_mode="blend", double_sided=True)
    model = scene((plate(0, half=3.0), facing_floor()), (plate(1, half=0.5), facing_floor(y=1.0)),
                  materials=[WHITE, pane], lights=(light,))
    camera = Camera.look_at((1.5, 0.3, 0.01), (0, 0, 0))
    settings = Settings.of(mode="path", spp=64, bounces=1, background="none")
    under = tracer.render(model, camera, settings, (32, 32)).linear[14:18, 14:18, 0]
    assert under.mean() == pytest.approx(1 - alpha, abs=0.05)
