from __future__ import annotations

import json
import weakref
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from viewer.errors import InputError
from viewer.scene.environment_files import MAX_WIDTH, load_environment
from viewer.scene.equirect import sphere_integral

CORPUS = Path(__file__).resolve().parents[2].parent / "shared" / "corpus"


def write(path: Path, pixels: np.ndarray, kind: str = "float", **attributes) -> Path:
    import OpenImageIO as oiio

    spec = oiio.ImageSpec(pixels.shape[1], pixels.shape[0], pixels.shape[2], kind)
    for name, value in attributes.items():
        setattr(spec, name, value)
    output = oiio.ImageOutput.create(str(path))
    assert output.open(str(path), spec), output.geterror()
    if attributes.get("tile_width"):
        assert output.write_tiles(0, pixels.shape[1], 0, pixels.shape[0], 0, 1, pixels)
    else:
        assert output.write_image(pixels)
    output.close()
    return path


def random_map(height: int = 8, width: int = 16, channels: int = 3) -> np.ndarray:
    return np.random.default_rng(3).random((height, width, channels)).astype(np.float32)


def test_radiance_hdr(tmp_path):
    pixels = random_map()
    environment = load_environment(write(tmp_path / "a.hdr", pixels))
    assert environment.name == "a"
    assert environment.radiance.dtype == np.float32
    assert np.abs(environment.radiance - pixels).max() < 1 / 128  # a shared exponent keeps 8 bits


@pytest.mark.parametrize("tiled", [False, True])
def test_exr(tmp_path, tiled):
    pixels = random_map(48, 96)
    tiles = {"tile_width": 16, "tile_height": 16} if tiled else {}
    assert np.array_equal(load_environment(write(tmp_path / "a.exr", pixels, **tiles)).radiance, pixels)


def test_exr_without_or_with_more_channels_than_colours(tmp_path):
    grey, rgba = random_map(channels=1), random_map(channels=4)
    assert np.array_equal(load_environment(write(tmp_path / "grey.exr", grey)).radiance, np.repeat(grey, 3, axis=2))
    assert np.array_equal(load_environment(write(tmp_path / "rgba.exr", rgba)).radiance, rgba[:, :, :3])
    layers = write(tmp_path / "z.exr", random_map(channels=4), channelnames=("Z", "R", "G", "B"))
    assert np.array_equal(load_environment(layers).radiance, random_map(channels=4)[:, :, 1:])


def test_png_is_decoded_from_srgb(tmp_path):
    pixels = np.full((2, 4, 3), 188 / 255, np.float32)
    assert load_environment(write(tmp_path / "a.png", pixels, "uint8")).radiance == pytest.approx(0.5029, abs=1e-3)


def test_a_map_that_is_too_wide_is_reduced_without_loss_of_light(tmp_path):
    pixels = random_map(64, MAX_WIDTH + 4)
    pixels[3, 7] = 5000
    radiance = load_environment(write(tmp_path / "wide.exr", pixels)).radiance
    assert radiance.shape == (32, MAX_WIDTH // 2 + 2, 3)
    assert sphere_integral(radiance) == pytest.approx(sphere_integral(pixels), rel=1e-5)


def test_values_that_are_no_radiance(tmp_path):
    pixels = random_map()
    pixels[1, 2], pixels[3, 4] = -1, np.inf
    radiance = load_environment(write(tmp_path / "mended.exr", pixels)).radiance
    assert radiance[1, 2].max() == 0
    assert radiance[3, 4].min() == 65504
    pixels[5, 6, 1] = np.nan
    with pytest.raises(InputError, match=r"nan\.exr: row 5, column 6: the value is not a number"):
        load_environment(write(tmp_path / "nan.exr", pixels)).radiance  # noqa: B018
    pixels[5, 6, 1] = 1e20
    with pytest.raises(InputError, match=r"row 5, column 6: radiance 1e\+20"):
        load_environment(write(tmp_path / "huge.exr", pixels)).radiance  # noqa: B018


def test_pixels_are_decoded_once_and_only_when_asked_for(tmp_path):
    path = write(tmp_path / "a.exr", random_map())
    environment = load_environment(path)
    turned = replace(environment, rotation=1.0)
    radiance = environment.radiance
    path.unlink()
    assert turned.radiance is radiance


def test_the_digest_is_of_the_content(tmp_path):
    one, same = write(tmp_path / "a.exr", random_map()), tmp_path / "b.exr"
    same.write_bytes(one.read_bytes())
    other = write(tmp_path / "c.exr", random_map() + 1)
    digests = [load_environment(path).digest for path in (one, same, other)]
    assert digests[0] == digests[1] != digests[2]
    assert digests[0]


@pytest.mark.parametrize("spec", [None, "none"])
def test_no_environment(spec):
    assert load_environment(spec) is None


def test_what_is_no_environment_is_one_line(tmp_path):
    (tmp_path / "folder.hdr").mkdir()
    (tmp_path / "notes.txt").write_text("hello")
    png = write(tmp_path / "a.png", random_map(), "uint8")
    png.rename(tmp_path / "png.hdr")
    for name, text in {"absent.hdr": "no such file", "folder.hdr": "is a folder", "notes.txt": ".txt files cannot be",
                       "stduio": "studio, sky, furnace", "png.hdr": "is a png file"}.items():
        with pytest.raises(InputError, match=text) as error:
            load_environment(tmp_path / name).radiance  # noqa: B018
        assert "\n" not in str(error.value)


def malformed() -> list:
    index = CORPUS / "INDEX.json"
    if not index.is_file():
        return []
    entries = json.loads(index.read_text())["malformed"]
    return [pytest.param(e, id=Path(e["path"]).name) for e in entries if Path(e["path"]).name.startswith("hdr-")]


@pytest.mark.parametrize("entry", malformed())
def test_malformed_files(entry):
    environment = None
    try:
        environment = load_environment(CORPUS / entry["path"])
        radiance = environment.radiance
    except InputError as error:
        assert entry["expect"] != "must load", error
        assert "\n" not in str(error)
    else:
        assert entry["expect"] != "error"
        assert np.isfinite(radiance).all()
        assert radiance.min() >= 0


def test_pixels_that_nobody_holds_are_let_go(tmp_path):
    environment = load_environment(write(tmp_path / "a.exr", random_map()))
    held = weakref.ref(environment.radiance)
    assert held() is None
    again = environment.radiance
    assert environment.radiance is again
