"""KTX2 images with Basis Universal texels, beside AVIF and WebP: what carries a texture in glTF."""

from __future__ import annotations

import io
import re
import struct

import numpy as np
import pytest
from byte_mutations import mutations
from gltf_builder import GltfBuilder, png_bytes
from needs import CORPUS, needs
from PIL import Image

from viewer.errors import InputError
from viewer.scene import ktx2
from viewer.scene.load import load_scene
from viewer.scene.texture_image import open_texture_image

COLORS = np.array([[[255, 0, 0, 255], [0, 255, 0, 128]], [[0, 0, 255, 0], [10, 20, 30, 40]]], np.uint8)
"""Of the blocks of a picture of 8 x 8 texels."""


def uastc_block(r: int, g: int, b: int, a: int) -> bytes:
    """Sixteen texels of one colour: mode 8 of UASTC, whose code is 10111, lowest bit first; hints for ETC stay 0."""
    return (0b10111 | r << 5 | g << 13 | b << 21 | a << 29).to_bytes(16, "little")


def zstandard(data: bytes) -> bytes:
    """A Zstandard frame with one raw block (RFC 8878, 3.1.1)."""
    return b"\x28\xb5\x2f\xfd\xa0" + struct.pack("<I", len(data)) + (1 | len(data) << 3).to_bytes(3, "little") + data


def ktx2_bytes(colors=COLORS, scheme: int = 0, size=None, channel: int = 3, **change: int) -> bytes:
    """A KTX2 with a block of texels for each of `colors`, (h, w, 4); `change` replaces numbers of its header."""
    raw = b"".join(uastc_block(*map(int, color)) for color in colors.reshape(-1, 4))
    stored = zstandard(raw) if scheme == 2 else raw
    width, height = size or (4 * colors.shape[1], 4 * colors.shape[0])
    head = {"vulkan": 0, "type": 1, "width": width, "height": height, "depth": 0, "layers": 0, "faces": 1, "levels": 1,
            "scheme": scheme, "descriptor": 104, "descriptor_size": 44, "pairs": 0, "pairs_size": 0, "shared": 0,
            "shared_size": 0, "level": 148, "level_size": len(stored), "level_raw": len(raw), **change}
    # The data format descriptor: one block of 40 bytes for UASTC (model 166), linear, 4 x 4 texels, one sample.
    block = struct.pack("<IIHHBBBB4B8B", 44, 0, 2, 40, 166, 1, 1, 0, 3, 3, 0, 0, 16, 0, 0, 0, 0, 0, 0, 0)
    sample = struct.pack("<HBB4BII", 0, 127, channel, 0, 0, 0, 0, 0, 0xFFFFFFFF)
    return ktx2.IDENTIFIER + struct.pack("<9I4I2Q3Q", *head.values()) + block + sample + stored


def avif_bytes(pixels: np.ndarray) -> bytes:
    out = io.BytesIO()
    Image.fromarray(pixels).save(out, "AVIF", quality=100, subsampling="4:4:4")
    return out.getvalue()


@pytest.mark.parametrize("scheme", [0, 2])
@pytest.mark.parametrize("channel, count", [(3, 4), (0, 3)])
def test_texels(scheme, channel, count):
    image = open_texture_image(ktx2_bytes(scheme=scheme, channel=channel), "x")
    assert (image.width, image.height, image.format, image.has_alpha) == (8, 8, "KTX2", count == 4)
    expected = COLORS.repeat(4, axis=0).repeat(4, axis=1)
    np.testing.assert_array_equal(image.decode(), expected[..., :count])
    np.testing.assert_array_equal(image.decode("GB"), expected[..., 1:3])
    np.testing.assert_array_equal(image.decode("A")[..., 0], expected[..., 3] if count == 4 else 255)


def test_sides_that_are_no_multiple_of_four():
    image = open_texture_image(ktx2_bytes(size=(7, 5)), "x")
    np.testing.assert_array_equal(image.decode(), COLORS.repeat(4, axis=0).repeat(4, axis=1)[:5, :7])


@needs("corpus")
def test_etc1s_is_close_to_the_picture_it_was_made_from():
    compressed, plain = (load_scene(CORPUS / "models" / path).materials[0].base_color_texture.image
                         for path in ("Duck-KTX-ETC1S/Duck.gltf", "Duck/Duck.glb"))
    difference = compressed.decode("RGB").astype(int) - plain.decode("RGB")
    assert np.abs(difference).mean() < 4


@pytest.mark.parametrize("data, words", [
    (ktx2_bytes()[:90], "ends inside its header"), (ktx2_bytes(vulkan=37), "is a KTX2 of Vulkan format 37"),
    (ktx2_bytes(depth=3), "is a KTX2 with more than one picture"),
    (ktx2_bytes(faces=6), "is a KTX2 with more than one picture"),
    (ktx2_bytes(layers=2), "is a KTX2 with more than one picture"),
    (ktx2_bytes(descriptor=2**31), "ends inside its data format descriptor"),
    (ktx2_bytes(scheme=1), r"is a KTX2 of color model \d+ with supercompression 1"),
    (ktx2_bytes(width=1 << 30, level_raw=1 << 33), r"has \d+ x \d+ texels; the limit is"),
    (ktx2_bytes(height=0, level_raw=0), r"has \d+ x 0 texels; the limit is"),
    (ktx2_bytes(level_raw=1 << 40), "declares 1099511627776 bytes")])
def test_broken_headers(data, words):
    with pytest.raises(InputError, match="^x: " + words):
        open_texture_image(data, "x")


@pytest.mark.parametrize("data", [
    ktx2_bytes(level=1 << 50), ktx2_bytes(level_size=1 << 50), ktx2_bytes()[:-20], ktx2_bytes(levels=99),
    ktx2_bytes(scheme=2)[:-20], ktx2_bytes(scheme=2, width=1 << 13, height=1 << 13, level_raw=1 << 26)])
def test_texels_that_are_broken_cost_that_texture(data):
    image = open_texture_image(data, "x", neutral=(0.0, 1.0, 0.0, 1.0))
    assert image.decode("RGB")[0, 0].tolist() == [0, 255, 0] and re.match("x: (its data|has) [^:]*$", image.problems[0])


def test_broken_data_does_no_harm():
    """A sample of what 10,000 mutations of each were tried for."""
    broken = 0
    for data in (ktx2_bytes(), ktx2_bytes(scheme=2), CARRIERS["EXT_texture_avif"]):
        for changed in mutations(data, 100):
            try:
                image = open_texture_image(changed, "x")
                if image.width * image.height <= 1 << 16:
                    broken += image.decode().shape[:2] == (image.height, image.width) and bool(image.problems)
            except InputError:
                broken += 1
    assert broken > 100


def textured(extension: str, data: bytes, fallback: bool, required: bool = False) -> GltfBuilder:
    """A triangle whose texture has an image by an extension, red, and perhaps a green one for readers without it."""
    builder = GltfBuilder(extensionsUsed=[extension], extensionsRequired=[extension] if required else [])
    texture: dict = {"extensions": {extension: {"source": builder.add("images", {"bufferView": builder.view(data)})}}}
    if fallback:
        green = builder.view(png_bytes(np.uint8([[[0, 255, 0]]])))
        texture["source"] = builder.add("images", {"bufferView": green, "mimeType": "image/png"})
    builder.add("textures", texture)
    material = builder.add("materials", {"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}})
    triangle = {"POSITION": builder.accessor([[0, 0, 0], [1, 0, 0], [0, 1, 0]]),
                "TEXCOORD_0": builder.accessor([[0, 0]] * 3)}
    builder.node(mesh=builder.mesh(triangle, material=material))
    return builder


RED = np.full((8, 8, 3), (255, 0, 0), np.uint8)
CARRIERS = {"KHR_texture_basisu": ktx2_bytes(np.uint8([[[255, 0, 0, 255]]]), channel=0),
            "EXT_texture_avif": avif_bytes(RED)}


@pytest.mark.parametrize("fallback", [True, False])
@pytest.mark.parametrize("extension", CARRIERS)
def test_gltf_takes_the_image_of_the_extension(extension, fallback):
    scene = textured(extension, CARRIERS[extension], fallback, required=not fallback).load()
    assert not scene.warnings
    np.testing.assert_allclose(scene.materials[0].base_color_texture.image.decode("RGB")[0, 0], [255, 0, 0], atol=2)


@pytest.mark.parametrize("fallback", [True, False])
def test_without_the_decoder_the_fallback_is_taken(monkeypatch, fallback):
    monkeypatch.setattr(ktx2, "is_installed", lambda: False)
    scene = textured("KHR_texture_basisu", CARRIERS["KHR_texture_basisu"], fallback).load()
    if fallback:
        assert scene.materials[0].base_color_texture.image.format == "PNG" and not scene.warnings
    else:
        assert scene.materials[0].base_color_texture is None
        assert "pip install opengl_basisu" in scene.warnings[0]


def test_a_broken_avif_costs_that_texture():
    data = CARRIERS["EXT_texture_avif"]
    scene = textured("EXT_texture_avif", data[:-20], False).load()
    image = scene.materials[0].base_color_texture.image
    assert image.decode("RGB").shape == (8, 8, 3) and image.problems
