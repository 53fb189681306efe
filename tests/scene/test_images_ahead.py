import io
import json
import struct
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from viewer.scene import images_ahead
from viewer.scene.images_ahead import decode_images_ahead, forget_images_ahead, load_image
from viewer.scene.texture_image import open_texture_image


def encoded(value: int, kind: str, side: int = 8) -> bytes:
    out = io.BytesIO()
    Image.new("RGB", (side, side), (value, 20, 30)).save(out, kind)
    return out.getvalue()


WOOD, STONE = encoded(200, "JPEG", 64), encoded(100, "PNG")


@pytest.fixture(autouse=True)
def ahead():
    yield images_ahead._ahead
    forget_images_ahead()


def decode_all(model: Path) -> None:
    thread = decode_images_ahead(str(model))
    thread.join(timeout=20)
    assert not thread.is_alive()


def gltf(folder: Path, *uris: str) -> Path:
    (folder / "wood.jpg").write_bytes(WOOD)
    (folder / "stone.png").write_bytes(STONE)
    path = folder / "model.gltf"
    path.write_text(json.dumps({"asset": {"version": "2.0"}, "images": [{"uri": uri} for uri in uris]}))
    return path


def glb(folder: Path, data: bytes) -> Path:
    root = {"asset": {"version": "2.0"}, "images": [{"bufferView": 0, "mimeType": "image/png"}],
            "bufferViews": [{"buffer": 0, "byteOffset": 4, "byteLength": len(data)}]}
    text, binary = json.dumps(root).encode(), b"    " + data
    text, binary = text + b" " * (-len(text) % 4), binary + b"\0" * (-len(binary) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(binary), b"BIN\0") + binary
    path = folder / "model.glb"
    path.write_bytes(struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks)
    return path


def test_images_beside_the_file_are_there_when_they_are_asked_for(tmp_path, ahead):
    decode_all(gltf(tmp_path, "stone.png", "wood.jpg"))
    assert set(ahead) == {WOOD, STONE}
    ready = {data: future.result() for data, future in ahead.items()}
    for data, kind in ((WOOD, "JPEG"), (STONE, "PNG")):
        assert load_image(data, kind) is ready[data]
        with Image.open(io.BytesIO(data)) as image:
            np.testing.assert_array_equal(np.asarray(ready[data]), np.asarray(image))
    assert not ahead
    assert load_image(WOOD, "JPEG").size == (64, 64)  # a second time it is decoded


def test_an_image_that_is_there_twice_is_decoded_once(tmp_path, ahead, caplog):
    decode_all(gltf(tmp_path, "wood.jpg", "wood.jpg", "stone.png"))
    assert set(ahead) == {WOOD, STONE} and all(future.done() for future in ahead.values())
    assert caplog.text == "", "futures tell of what is set twice"


def test_images_in_the_binary_chunk_are_found(tmp_path, ahead):
    decode_all(glb(tmp_path, STONE))
    assert set(ahead) == {STONE}
    pixels = open_texture_image(STONE, "stone").decode()
    assert not ahead and pixels[0, 0].tolist() == [100, 20, 30]


@pytest.mark.parametrize("uri", ["../wood.jpg", "none.jpg", "data:image/png;base64,AAAA", "model.gltf"])
def test_what_cannot_be_read_is_left_to_the_reader(tmp_path, ahead, uri):
    (tmp_path / "inside").mkdir()
    (tmp_path / "wood.jpg").write_bytes(WOOD)
    decode_all(gltf(tmp_path / "inside", uri))
    assert not ahead


@pytest.mark.parametrize("name, content", [
    ("a.gltf", b"{"), ("a.gltf", b'{"images": [7]}'), ("a.glb", b"glTF"), ("a.obj", b"v 0 0 0"), ("none.gltf", None)])
def test_broken_models_raise_nothing(tmp_path, ahead, name, content):
    if content is not None:
        (tmp_path / name).write_bytes(content)
    decode_all(tmp_path / name)
    assert not ahead


def test_a_broken_image_is_told_where_it_is_asked_for(tmp_path, ahead):
    model = gltf(tmp_path, "wood.jpg", "stone.png", "text.png")
    (tmp_path / "text.png").write_bytes(b"no image, but longer than the others: " * 99)
    broken = WOOD[:-20]
    (tmp_path / "wood.jpg").write_bytes(broken)
    decode_all(model)
    assert set(ahead) == {broken, STONE}
    image = open_texture_image(broken, "wood.jpg")
    assert image.decode("RGB").shape == (64, 64, 3) and image.problems[0].startswith("wood.jpg: cannot be decoded")


def test_images_that_would_take_too_much_memory_are_not_decoded(tmp_path, ahead, monkeypatch):
    monkeypatch.setattr(images_ahead, "_MOST_TEXELS", 64 * 64)
    decode_all(gltf(tmp_path, "stone.png", "wood.jpg"))
    assert set(ahead) == {WOOD}  # the larger file is the first
    forget_images_ahead()
    assert not ahead


def test_an_image_whose_turn_has_not_come_is_decoded_by_who_asks(ahead):
    ahead[STONE] = waiting = images_ahead.Future()
    assert load_image(STONE, "PNG").size == (8, 8) and waiting.cancelled()
