"""Several points of each pixel shaded: the picture is the larger one, averaged."""

from __future__ import annotations

import numpy as np
from shapes import lopsided, orthographic, scene, sphere

from viewer.measure.relmse import reduced
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


def test_a_part_is_that_of_the_whole(renderer):
    settings = Settings.of(antialias="ssaa-4", background="none")
    whole = renderer.render(SCENE, VIEW, settings, (24, 16)).linear[::-1]
    renderer.draw(SCENE, VIEW, Settings.of(antialias="ssaa-4"), (24, 16), half=False)
    renderer.draw(SCENE, VIEW, settings, (24, 16), half=False, still=True, part=(4, 6, 8, 5))
    pixels = np.frombuffer(renderer._target.read(), np.float32).reshape(16, 24, 4)
    assert np.array_equal(pixels[6:11, 4:12], whole[6:11, 4:12])
    assert pixels[0, 0, 3] == 1 and whole[0, 0, 3] == 0
