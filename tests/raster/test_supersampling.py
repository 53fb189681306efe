"""Several points of each pixel shaded: the picture is the larger one, averaged."""

from __future__ import annotations

import numpy as np
import pytest
from shapes import WHITE, facing_floor, lopsided, moved, orthographic, plate, scene, sphere

from viewer.measure.compare.relmse import reduced
from viewer.scene.material import Material
from viewer.settings import Settings

VIEW = orthographic(0.3, 0.2, height=2.4)
SCENE = scene(sphere(), materials=[Material(perceptual_roughness=0.1)], environment=lopsided())


def test_it_is_the_larger_picture_averaged(renderer):
    for antialias, k in (("ssaa-4", 2), ("ssaa-9", 3), ("ssaa-16", 4)):
        small = renderer.render(SCENE, VIEW, Settings.of(antialias=antialias), (24, 16)).linear
        large = renderer.render(SCENE, VIEW, Settings.of(antialias="none"), (24 * k, 16 * k)).linear
        assert small.shape == (16, 24, 4)
        assert np.abs(small - reduced(large, k)).max() < 1e-4 * large.max()


@pytest.mark.parametrize("setting", [{"environment_shadows": "16"}, {"ambient_occlusion": "gtao"},
                                     {"reflections": "traced"}])
def test_what_is_found_for_each_pixel_is_found_between_them(renderer, setting):
    stand = scene((sphere(), moved((0, 0.5, 0), 0.4)), (plate(1), facing_floor()), environment=lopsided(),
                  materials=[WHITE, Material(perceptual_roughness=0.3)])
    view = orthographic(0.3, 0.6, height=2.4)
    large, small = (renderer.render(stand, view, Settings.of(antialias=antialias, **setting), size).linear
                    for antialias, size in (("none", (144, 96)), ("ssaa-9", (48, 32))))
    bare = renderer.render(stand, view, Settings.of(antialias="ssaa-9"), (48, 32)).linear
    error = np.abs(small - reduced(large, 3))[..., :3].mean()
    assert error < 0.1 * np.abs(small - bare)[..., :3].mean()


def test_pictures_with_baked_light_are_supersampled_by_themselves(renderer):
    stand = scene((sphere(), moved((0, 0.5, 0), 0.4)), (plate(1), facing_floor()), environment=lopsided(),
                  materials=[WHITE, WHITE])
    baked, shaded, plain = (renderer.render(stand, VIEW, Settings.of(**options), (24, 16)).linear for options in (
        {"indirect": "baked"}, {"indirect": "baked", "antialias": "ssaa-4"},
        {"indirect": "baked", "antialias": "msaa-4"}))
    assert np.array_equal(baked, shaded) and not np.array_equal(baked, plain)


def test_a_part_is_that_of_the_whole(renderer):
    settings = Settings.of(antialias="ssaa-4", background="none")
    whole = renderer.render(SCENE, VIEW, settings, (24, 16)).linear[::-1]
    renderer.draw(SCENE, VIEW, Settings.of(antialias="ssaa-4"), (24, 16), half=False)
    renderer.draw(SCENE, VIEW, settings, (24, 16), half=False, still=True, part=(4, 6, 8, 5))
    pixels = np.frombuffer(renderer._target.read(), np.float32).reshape(16, 24, 4)
    assert np.array_equal(pixels[6:11, 4:12], whole[6:11, 4:12])
    assert pixels[0, 0, 3] == 1 and whole[0, 0, 3] == 0
