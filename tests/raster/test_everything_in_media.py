"""The plan that leaves nothing out draws volumes as they are, under the lights that there are."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from shapes import WHITE, facing_floor, plate, scene
from test_everything import assert_same

from viewer.scene.camera import Camera
from viewer.scene.light import Light
from viewer.scene.volume import Volume


def test_black_lights_stand_before_others_in_smoke_and_fire(renderer):
    """A lamp, and the lights of what the smoke emits, have other numbers than without the black sun before them."""
    lamp = Light("point", intensity=30.0, position=(2, 3, 1))
    smoke = Volume.in_box(np.ones((4, 4, 4), np.float32), [[-0.5, 1.5, -0.5], [0.5, 2.5, 0.5]])
    model = replace(scene((plate(half=4.0), facing_floor()), materials=(WHITE,), lights=(lamp,)), volumes=(smoke,))
    assert_same(renderer, model, Camera.look_at((0, 3, 8), (0, 1, 0)), volume_density=0.5, volume_emission=(2, 1, 0),
                background="none")
