"""viewer/image/image.py and viewer/base/atomic.py: formats, exactness, and that a file is whole or not there."""

from __future__ import annotations

import copy
import json
import pickle
from dataclasses import replace
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
import pytest
from PIL import Image as Pillow

from viewer.base.atomic import atomic_write, write_json
from viewer.errors import InputError, OutputError, UsageError
from viewer.image.image import Image


@pytest.fixture
def image() -> Image:
    rng = np.random.default_rng(7)
    linear = rng.uniform(0, 4, (13, 17, 4)).astype(np.float32)
    linear[..., 3] = rng.uniform(0.1, 1, (13, 17))
    return Image(linear, rng.integers(0, 256, (13, 17, 4), np.uint8))


def leftovers(folder) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


@pytest.mark.parametrize("suffix", [".png", ".webp", ".PNG"])
def test_lossless_formats_keep_every_displayed_bit(image, tmp_path, suffix):
    image.save(tmp_path / f"a{suffix}")
    assert np.array_equal(Image.open(tmp_path / f"a{suffix}").srgb, image.srgb)
    assert leftovers(tmp_path) == [f"a{suffix}"]


def test_exr_keeps_every_linear_bit(image, tmp_path):
    image.save(tmp_path / "a.exr")
    assert np.array_equal(Image.open(tmp_path / "a.exr").linear, image.linear)


def test_layers_lie_beside_the_picture_in_one_exr(image, tmp_path):
    import OpenImageIO as oiio

    rng = np.random.default_rng(8)
    shapes = {"samples": (13, 17), "normal": (13, 17, 3), "albedo": (13, 17, 3), "depth": (13, 17)}
    layers = {name: rng.normal(0, 9, shape).astype(np.float32) for name, shape in shapes.items()}
    layers["depth"][0, 0] = np.inf
    replace(image, layers=layers, attributes={"denoised": "fast"}).save(tmp_path / "a.exr")
    assert np.array_equal(Image.open(tmp_path / "a.exr").linear, image.linear)
    source = oiio.ImageInput.open(str(tmp_path / "a.exr"))
    names, pixels = source.spec().channelnames, source.read_image("float")
    assert set(names) == {*"RGBA", "samples.Y", "normal.X", "normal.Y", "normal.Z", "albedo.R", "albedo.G", "albedo.B",
                          "depth.Z"}
    assert source.spec().get_string_attribute("denoised") == "fast"
    for name, suffix in (("samples", "Y"), ("normal", "XYZ"), ("albedo", "RGB"), ("depth", "Z")):
        stored = pixels[..., [names.index(f"{name}.{c}") for c in suffix]]
        assert np.array_equal(stored.reshape(shapes[name]), layers[name])
    assert leftovers(tmp_path) == ["a.exr"]


def test_npz_and_exr_keep_whole_numbers_and_pairs(image, tmp_path):
    """Of uint32 each number, also those that a float32 has not; npz keeps float64, too."""
    import OpenImageIO as oiio

    rng = np.random.default_rng(9)
    ids = rng.integers(0, 1 << 32, (13, 17), dtype=np.uint32)
    layers = {"instance": ids, "material": ids[::-1].copy(), "uv": rng.normal(size=(13, 17, 2)).astype(np.float32),
              "motion": rng.normal(size=(13, 17, 2)).astype(np.float32), "position": 1e6 + rng.normal(size=(13, 17, 3))}
    shown = replace(image, layers=layers, attributes={"denoised": "fast"})
    for name in ("a.exr", "a.npz"):
        shown.save(tmp_path / name)
    assert leftovers(tmp_path) == ["a.exr", "a.npz"]
    with np.load(tmp_path / "a.npz") as stored:
        assert set(stored) == {"rgba", *layers} and np.array_equal(stored["rgba"], image.linear)
        assert all(np.array_equal(stored[name], layer) and stored[name].dtype == layer.dtype
                   for name, layer in layers.items())
    assert np.array_equal(Image.open(tmp_path / "a.exr").linear, image.linear)
    source = oiio.ImageInput.open(str(tmp_path / "a.exr"))
    assert source.spec().get_string_attribute("denoised") == "fast"
    names, pixels = source.spec().channelnames, source.read_image("float")
    for name, suffix in (("uv", "UV"), ("motion", "XY"), ("position", "XYZ")):
        found = pixels[..., [names.index(f"{name}.{c}") for c in suffix]]
        assert np.array_equal(found, layers[name].astype(np.float32))
    assert source.seek_subimage(1, 0) and source.spec().channelnames == ("instance.Y", "material.Y")
    found = source.read_image(1, 0, 0, 2, "uint")
    assert np.array_equal(found[..., 0], ids) and np.array_equal(found[..., 1], ids[::-1])


def test_a_png_says_what_was_done_to_it(image, tmp_path):
    replace(image, attributes={"denoised": "fast"}).save(tmp_path / "a.png")
    assert Pillow.open(tmp_path / "a.png").text == {"denoised": "fast"}


def test_a_layer_of_another_size_is_refused(image):
    for layer in (np.zeros((2, 2), np.float32), np.zeros((13, 17), int), np.zeros((13, 17, 4), np.float32)):
        with pytest.raises(UsageError, match=r"Image\.layers\['depth'\] is \("):
            replace(image, layers={"depth": layer})


def test_jpeg_lies_over_white(tmp_path):
    pixels = np.zeros((16, 32, 4), np.uint8)
    pixels[:, 16:] = 200, 100, 50, 255
    Image.from_srgb(pixels).save(tmp_path / "a.jpg")
    shown = Image.open(tmp_path / "a.jpg").srgb.astype(int)
    assert np.abs(shown[:, :14, :3] - 255).max() <= 3
    assert np.abs(shown[:, 18:, :3] - [200, 100, 50]).max() <= 3
    assert (shown[..., 3] == 255).all()


def test_decoding_is_exact_srgb_with_associated_alpha():
    image = Image.from_srgb(np.array([[[10, 128, 255, 255], [10, 128, 255, 51]]], np.uint8))
    straight = [10 / 255 / 12.92, ((128 / 255 + 0.055) / 1.055) ** 2.4, 1.0]
    assert image.linear[0, 0] == pytest.approx([*straight, 1.0], rel=1e-6)
    assert image.linear[0, 1] == pytest.approx([0.2 * value for value in straight] + [0.2], rel=1e-6)


def test_eight_bits_survive_the_way_through_linear():
    levels = np.arange(256, dtype=np.uint8)
    pixels = np.stack([levels, levels[::-1], levels, np.full(256, 255, np.uint8)], axis=-1)[None]
    assert np.array_equal(Image.from_linear(Image.from_srgb(pixels).linear).srgb, pixels)


def test_linear_values_beyond_the_screen_are_clamped():
    shown = Image.from_linear(np.array([[[5.0, -1.0, np.nan], [np.inf, 0.5, 0.0]]], np.float32)).srgb
    assert shown.tolist() == [[[255, 0, 0, 255], [255, 188, 0, 255]]]


def test_rgb_and_grey_exr_and_hdr_open(tmp_path):
    for name, channels in (("rgb.exr", 3), ("grey.exr", 1), ("rgb.hdr", 3)):
        pixels = np.full((4, 5, channels), 0.5, np.float32)
        spec = oiio.ImageSpec(5, 4, channels, "float")
        spec.channelnames = ("Y",) if channels == 1 else ("R", "G", "B")
        target = oiio.ImageOutput.create(str(tmp_path / name))
        assert target.open(str(tmp_path / name), spec) and target.write_image(pixels) and target.close()
        assert np.array_equal(Image.open(tmp_path / name).linear, np.full((4, 5, 4), [0.5, 0.5, 0.5, 1], np.float32))


def test_sixteen_bit_and_palette_png_open(tmp_path):
    Pillow.fromarray(np.full((4, 4), 0x8080, np.uint16)).save(tmp_path / "deep.png")
    assert (Image.open(tmp_path / "deep.png").srgb == [128, 128, 128, 255]).all()
    Pillow.new("P", (4, 4), 0).save(tmp_path / "palette.png")
    assert Image.open(tmp_path / "palette.png").srgb.shape == (4, 4, 4)


def test_numpy_and_notebooks_see_the_right_half(image):
    assert np.asarray(image) is image.linear
    assert np.asarray(image, np.float64).dtype == np.float64
    assert image._repr_png_().startswith(b"\x89PNG")
    assert repr(image) == "Image(17x13)" and image.size == (17, 13)


def test_over_a_background_is_exact():
    image = Image.from_srgb(np.array([[[255, 0, 51, 51]]], np.uint8))
    assert image.over(1.0)[0, 0] == pytest.approx([1.0, 0.8, 0.84], abs=1e-6)
    assert image.over(0.0)[0, 0] == pytest.approx([0.2, 0.0, 0.04], abs=1e-6)


@pytest.mark.parametrize("linear, srgb", [
    (np.zeros((2, 2, 4), np.float64), np.zeros((2, 2, 4), np.uint8)),
    (np.zeros((2, 2, 3), np.float32), np.zeros((2, 2, 3), np.uint8)),
    (np.zeros((2, 3, 4), np.float32), np.zeros((2, 2, 4), np.uint8)),
])
def test_a_wrong_shape_or_type_is_refused(linear, srgb):
    with pytest.raises(UsageError, match=r"Image\.linear is \("):
        Image(linear, srgb)


@pytest.mark.parametrize("make, words", [
    (lambda: Image.from_srgb(np.ones((2, 2, 3))), r"pixels are \(2, 2, 3\) float64, not \(H, W, 3 or 4\) uint8"),
    (lambda: Image.from_srgb(np.full((2, 2, 3), 300)), r"pixels are from 300 to 300, not from 0 to 255"),
    (lambda: Image.from_srgb(None), r"pixels are \(\) object"),
    (lambda: Image.from_linear("red"), r"pixels are \(\) <U3, not \(H, W, 3 or 4\) float32"),
    (lambda: Image.from_linear([[[1, 2, 3], [1, 2]]]), r"pixels are \(\) object"),
    (lambda: Image.from_linear(np.zeros((0, 2, 3))), r"pixels are \(0, 2, 3\) float64"),
    (lambda: Image(3, 4), r"Image\.linear is of type int, not an array"),
    (lambda: Image(np.zeros((2, 2, 4), np.float32), np.zeros((2, 2, 4), np.uint8), layers={"depth": 3}),
     r"Image\.layers\['depth'\] is of type int, not an array"),
])
def test_what_is_no_picture_is_one_line(make, words):
    with pytest.raises(UsageError, match=words):
        make()


def test_displayed_values_may_be_of_any_whole_numbers():
    assert np.array_equal(Image.from_srgb([[[0, 128, 255]]]).srgb, np.uint8([[[0, 128, 255, 255]]]))


@pytest.mark.parametrize("failure", [KeyboardInterrupt, MemoryError, OSError("disk full")])
@pytest.mark.parametrize("suffix", [".png", ".exr"])
def test_a_failing_encoder_leaves_the_old_file_and_nothing_else(image, tmp_path, monkeypatch, failure, suffix):
    target = tmp_path / f"a{suffix}"
    target.write_bytes(b"old")

    def fail(*args, **options):
        raise failure

    replaced = "write_exr" if suffix == ".exr" else "Image._encode"
    monkeypatch.setattr(f"viewer.image.image.{replaced}", fail)
    with pytest.raises(OutputError if isinstance(failure, OSError) else failure):
        image.save(target)
    assert target.read_bytes() == b"old" and leftovers(tmp_path) == [target.name]


def test_until_the_end_of_the_block_the_old_file_stands(tmp_path):
    target = tmp_path / "report.json"
    target.write_text("old")
    with atomic_write(target) as temporary:
        temporary.write_text("new")
        assert target.read_text() == "old" and temporary.parent == tmp_path and temporary.suffix == ".json"
    assert target.read_text() == "new" and leftovers(tmp_path) == ["report.json"]


def test_json_is_whole_and_valid_or_not_there(tmp_path):
    write_json(tmp_path / "a.json", {"a": [1, "\udcff"]})
    assert json.loads((tmp_path / "a.json").read_text()) == {"a": [1, "\udcff"]}
    with pytest.raises(ValueError):
        write_json(tmp_path / "b.json", {"a": float("nan")})
    assert leftovers(tmp_path) == ["a.json"]


def test_links_and_pipes_stay_what_they_are(tmp_path):
    (tmp_path / "link").symlink_to("real")
    with atomic_write(tmp_path / "link") as temporary:
        temporary.write_text("new")
    assert (tmp_path / "link").is_symlink() and (tmp_path / "real").read_text() == "new"
    (tmp_path / "link.exr").symlink_to("data.bin")
    with atomic_write(tmp_path / "link.exr") as temporary:
        assert temporary.suffix == ".exr"  # of the name that was given: encoders go by it
    with atomic_write("/dev/null") as temporary:
        temporary.write_text("gone")
    assert Path("/dev/null").is_char_device()


def test_output_errors_are_one_line_that_says_what_is_wrong(image, tmp_path):
    (tmp_path / "folder.png").mkdir()
    (tmp_path / "file").write_text("")
    for path, words in [("a.gif", "cannot write .gif; choose one of .png, .jpg, .jpeg, .webp, .exr"),
                        ("a", "without extension"), ("none/a.png", "does not exist"), ("folder.png", "is a folder"),
                        ("file/a.png", "does not exist")]:
        with pytest.raises(OutputError, match=words) as caught:
            image.save(tmp_path / path)
        assert "\n" not in str(caught.value) and str(tmp_path / path) in str(caught.value)
    wide = Image.from_srgb(np.zeros((1, 17000, 4), np.uint8))
    with pytest.raises(OutputError, match="16383"):
        wide.save(tmp_path / "wide.webp")
    assert leftovers(tmp_path) == ["file", "folder.png"]


def test_broken_inputs_are_one_line_errors(image, tmp_path):
    for name in ("a.png", "a.webp", "a.exr", "a.jpg"):
        image.save(tmp_path / name)
        whole = (tmp_path / name).read_bytes()
        for cut in (0, 20, len(whole) // 2):
            (tmp_path / name).write_bytes(whole[:cut])
            with pytest.raises(InputError) as caught:
                Image.open(tmp_path / name)
            assert "\n" not in str(caught.value) and "ERR" not in str(caught.value)
    with pytest.raises(InputError, match="no such file"):
        Image.open(tmp_path / "none.png")
    with pytest.raises(InputError, match="is a folder"):
        Image.open(tmp_path)
    (tmp_path / "text.png").write_text("hello")
    with pytest.raises(InputError, match="is not a picture in a supported format"):
        Image.open(tmp_path / "text.png")


def test_a_picture_bomb_is_refused_before_it_is_decoded(tmp_path):
    Pillow.new("1", (20000, 20000)).save(tmp_path / "bomb.png")
    with pytest.raises(InputError, match="20000x20000|decompression bomb"):
        Image.open(tmp_path / "bomb.png")


def test_linear_is_worked_out_when_asked_for_and_kept():
    image = Image.from_srgb(np.full((2, 2, 4), 255, np.uint8))
    for one in (image, copy.copy(image), pickle.loads(pickle.dumps(image)), replace(image, stats={"a": 1})):
        assert one.linear is one.linear and (one.linear == 1).all() and one.size == (2, 2)
    with pytest.raises(AttributeError, match=r"no attribute 'pixels'; .* in `linear` .* and `srgb` ") as caught:
        image.pixels  # noqa: B018
    assert (caught.value.name, caught.value.obj) == ("pixels", image)
