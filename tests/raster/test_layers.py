"""All combinations of layers in the white furnace: none gains light, and none loses more than a hundredth."""

from __future__ import annotations

from itertools import combinations

import pytest
from shapes import constant, orthographic, scene

from viewer.measure.check.scenes import sphere
from viewer.scene.material import Material

LAYERS = {
    "coat": {"clearcoat": 1.0, "clearcoat_roughness": 0.3},
    "sheen": {"sheen_color": (1.0, 1.0, 1.0), "sheen_roughness": 0.4},
    "anisotropy": {"anisotropy_strength": 0.7, "anisotropy_rotation": 0.4},
    "plaster": {"diffuse_roughness": 0.8},
    "paper": {"diffuse_transmission": 0.4, "double_sided": True},
}
FILM = {"iridescence": 1.0, "iridescence_ior": 1.6, "iridescence_thickness_maximum": 300.0}
COMBINED = [names for count in range(2, len(LAYERS) + 1) for names in combinations(LAYERS, count)]


COMBINED += [("film",), *((name, "film") for name in LAYERS), (*LAYERS, "film")]


@pytest.mark.parametrize("names", COMBINED, ids="-".join)
def test_white_vanishes_under_all_layers_at_once(radiance, names):
    layers = {key: value for name in names for key, value in (LAYERS | {"film": FILM})[name].items()}
    white = Material(metallic=0.5, perceptual_roughness=0.5, **layers)
    picture = radiance(scene(sphere(), materials=[white], environment=constant()),
                       orthographic(0.4, 0.3, height=2.1), (32, 32))[..., :3]
    assert picture.min() > 0.99 and picture.max() < 1.0005
