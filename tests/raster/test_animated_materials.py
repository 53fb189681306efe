"""Materials that are animated: at a time, the same pixels as of a file that has at rest what it is then."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from gltf_builder import GltfBuilder
from shapes import lopsided, orthographic

from viewer.scene.scene import Scene
from viewer.settings import Settings

GLOSSY = "KHR_materials_pbrSpecularGlossiness"
TEXELS = np.uint8([[[255, 128, 64, 255], [64, 255, 128, 64]], [[128, 64, 255, 128], [255, 255, 255, 0]]])
FIRST = {"diffuseFactor": [0.5, 0.25, 0.125, 1], "specularFactor": [0.25, 0.5, 0.125], "glossinessFactor": 0.25}
LAST = {"diffuseFactor": [0.25, 0.5, 0.75, 1], "specularFactor": [0.75, 0.25, 0.5], "glossinessFactor": 0.75}


def plate(factors: dict, last: dict, is_mapped: bool) -> Scene:
    """A plate that faces the camera. Its factors are at 0 s `factors`, and at 1 s `last`, those that are there."""
    builder = GltfBuilder()
    glossy = factors | ({"specularGlossinessTexture": {"index": builder.texture(TEXELS)}} if is_mapped else {})
    builder.add("materials", {"extensions": {GLOSSY: glossy}})
    channels, samplers = [], []
    for name, value in last.items():
        pointer = f"/materials/0/extensions/{GLOSSY}/{name}"
        samplers.append({"input": builder.accessor([0, 1]), "output": builder.accessor([factors[name], value])})
        channels.append({"sampler": len(channels), "target": {
            "path": "pointer", "extensions": {"KHR_animation_pointer": {"pointer": pointer}}}})
    if channels:
        builder.add("animations", {"samplers": samplers, "channels": channels})
    corners = np.float32([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]])
    builder.node(mesh=builder.mesh({
        "POSITION": builder.accessor(corners), "TEXCOORD_0": builder.accessor((corners[:, :2] + 1) / 2)},
        indices=builder.accessor([0, 1, 2, 0, 2, 3], "uint16"), material=0))
    scene = builder.load()
    assert not scene.warnings
    return replace(scene, environment=lopsided())


@pytest.mark.parametrize("is_mapped", [False, True], ids=["factors", "map"])
def test_specular_and_glossiness(renderer, is_mapped):
    """All of the factors in turn, and then all together, in one renderer."""
    def picture(scene: Scene) -> np.ndarray:
        return renderer.render(scene, orthographic(), Settings(antialias="none"), (24, 24)).linear

    first = picture(plate(FIRST, {}, is_mapped))
    for last in (*({name: value} for name, value in LAST.items()), LAST):
        moving = plate(FIRST, last, is_mapped)
        still = picture(plate(FIRST | last, {}, is_mapped))
        np.testing.assert_array_equal(picture(moving.at(1)), still)
        assert np.abs(still - first).max() > 0.01
        np.testing.assert_array_equal(picture(moving.at(0)), first)
