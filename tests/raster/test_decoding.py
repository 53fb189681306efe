"""Images decoded on other threads: each once, in the channels that are read, errors and all."""

from __future__ import annotations

import io
import threading
import time
from dataclasses import replace

import numpy as np
import pytest
from PIL import Image
from shapes import plate
from shapes import scene as scene_of
from waiting import wait_until

import viewer
from viewer.base.resources import resource_folder
from viewer.errors import InputError
from viewer.plan.planner import plan_scene
from viewer.raster.sampled_images import channels_read, decode_ahead, sampled_images
from viewer.scene.decoding import Decoder, decode_levels
from viewer.scene.mask_levels import MaskMap
from viewer.scene.material import Material, Texture
from viewer.scene.texture_image import open_texture_image
from viewer.settings import Settings


def encoded(pixels: np.ndarray, name: str = "image"):
    file = io.BytesIO()
    Image.fromarray(pixels).save(file, "PNG")
    return open_texture_image(file.getvalue(), name)


@pytest.fixture(scope="module")
def pixels() -> np.ndarray:
    return np.random.default_rng(1).integers(0, 256, (40, 24, 4), np.uint8)


@pytest.fixture(scope="module")
def scene():
    return viewer.load(resource_folder("assets") / "scenes" / "textures.glb")


def test_all_come_once_with_all_their_levels(pixels):
    keys = [(encoded(pixels[k:]), "RGB", "srgb" if k % 2 else "linear") for k in range(9)]
    results = dict(Decoder(keys).results())
    assert set(results) == set(keys)
    for k, key in enumerate(keys):
        assert np.array_equal(results[key][0], pixels[k:, :, :3])
        assert results[key][-1].shape == (1, 1, 3)


def test_nothing_to_decode():
    assert list(Decoder([]).results()) == []


def test_no_more_than_a_few_are_held_at_once(pixels, monkeypatch):
    begun = []
    monkeypatch.setattr("viewer.scene.decoding.decode_levels", lambda *key: begun.append(key) or [pixels])
    decoder = Decoder([(encoded(pixels), "RGB", "linear") for _ in range(9)])
    wait_until(lambda: len(begun) >= 4)
    time.sleep(0.05)  # for more, if there were more
    assert len(begun) == 4
    assert len(list(decoder.results())) == 9


def test_an_error_is_raised_where_results_are_asked_for(pixels):
    broken = encoded(pixels, "broken.png")

    def decode(image, channels, encoding):
        if image is broken:
            raise InputError(image.name, "", "cannot be decoded")
        return decode_levels(image, channels, encoding)

    decoder = Decoder([(broken, "RGB", "linear"), *((encoded(pixels), "RGB", "linear") for _ in range(6))], decode)
    with pytest.raises(InputError, match="broken.png"):
        list(decoder.results())


def test_cancelled_threads_end(pixels):
    before = threading.active_count()
    decoder = Decoder([(encoded(pixels), "RGB", "linear") for _ in range(9)])
    decoder.cancel()
    wait_until(lambda: threading.active_count() <= before)


@pytest.mark.parametrize("settings", [Settings(), Settings(mode="phong"), Settings(lobes="specular")])
def test_ahead_of_the_plan_the_same_images_are_decoded(scene, settings):
    light = viewer.Light.from_angles(0.3, 0.8, 3.0)
    plan = plan_scene(scene, settings, (light,), samples=4, half_target=True, orthographic=True)
    ahead = decode_ahead(scene, settings)
    assert ahead.keys == sampled_images(plan, channels_read(plan, {})) and ahead.keys
    ahead.cancel()


def test_what_another_plan_read_is_kept(scene):
    plan = plan_scene(scene, Settings(), (), samples=1, half_target=False, orthographic=False)
    read = channels_read(plan, {})
    image = next(iter(read))
    assert channels_read(plan, {image: "RGBA"})[image] == "RGBA"


@pytest.mark.parametrize("material, letters, meaning", [
    (Material(alpha_mode="opaque"), "RGB", "srgb"), (Material(alpha_mode="mask"), "RGBC", MaskMap(0.5, True)),
    (Material(alpha_mode="mask", alpha_cutoff=0.0), "RGBC", "srgb"), (Material(alpha_mode="blend"), "RGBC", "srgb"),
])
def test_only_alpha_that_covers_is_read_as_coverage(pixels, material, letters, meaning):
    texture = Texture(encoded(pixels))
    plan = plan_scene(scene_of(plate(), materials=[replace(material, base_color_texture=texture)]), Settings(), (),
                      samples=1, half_target=False, orthographic=False)
    assert channels_read(plan, {}) == {(texture.image, meaning): letters}


def test_an_opaque_map_keeps_what_its_alpha_would_hide(pixels):
    texture = Texture(encoded(pixels))
    both = [Material(alpha_mode=mode, base_color_texture=texture) for mode in ("opaque", "blend")]
    plan = plan_scene(scene_of(plate(0), plate(1), materials=both), Settings(), (), samples=1, half_target=False,
                      orthographic=False)
    assert channels_read(plan, {}) == {(texture.image, "srgb"): "RGBCO"}


def test_channels(pixels):
    image = encoded(pixels)
    assert np.array_equal(decode_levels(image, "R", "linear")[0], pixels[..., :1])
    assert np.array_equal(decode_levels(image, "RGB", "srgb")[0], pixels[..., :3])
    assert np.array_equal(decode_levels(image, "RGBA", "srgb")[0], pixels)
    grey = encoded(pixels[..., 0])
    assert decode_levels(grey, "RGB", "linear")[0].shape[2] == 1
    assert np.array_equal(decode_levels(grey, "RGB", "srgb")[0], pixels[..., [0, 0, 0]])
