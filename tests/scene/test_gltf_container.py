import json
import struct
from pathlib import Path

import pytest
from gltf_builder import GltfBuilder, triangle_glb

from viewer.errors import InputError
from viewer.scene.gltf import load_gltf


def load(data: bytes, name: str = "model.glb"):
    return load_gltf(Path(name), data)


def test_a_glb_and_its_facts():
    builder = GltfBuilder(asset={"version": "2.0", "generator": "us", "copyright": "nobody"})
    builder.node(mesh=builder.triangle())
    facts = builder.load().facts
    assert facts["format"] == "GLB 2.0" and facts["generator"] == "us" and facts["copyright"] == "nobody"
    json.dumps(facts)


@pytest.mark.parametrize("damage, place", [
    (lambda d: d[:8], "header"), (lambda d: b"GLTF" + d[4:], "header"),
    (lambda d: d[:4] + struct.pack("<I", 1) + d[8:], "header.version"), (lambda d: d[:-8], "header.length"),
    (lambda d: d[:12] + struct.pack("<I", 1 << 31) + d[16:], r"chunks\[0\]"),
    (lambda d: d[:16] + b"BIN\0" + d[20:], r"chunks\[0\]")])
def test_broken_glbs(damage, place):
    with pytest.raises(InputError, match=place):
        load(damage(triangle_glb()))


@pytest.mark.parametrize("text, problem", [
    (b"", "JSON"), (b"{", "line 1"), (b"[]", "object"), (b'{"a": "\xff"}', "UTF-8"), (b'{"a": NaN}', "JSON: NaN"),
    (b"[" * 100_000, "JSON: nested too deeply"),
    (b'{"asset": {"version": "2.0"}, "nodes": [{"translation": [1e999, 0, 0]}]}', "finite"),
    (b'{"scenes": []}', "asset"), (b'{"asset": {"version": "2.0"}, "nodes": null}', "nodes: .*null"),
    (b'{"asset": {"version": "2.0"}, "x": ' + b"9" * 5000 + b"}", "JSON: a number has thousands of digits")])
def test_broken_json(text, problem):
    with pytest.raises(InputError, match=problem) as caught:
        load(text, "model.gltf")
    assert "\n" not in str(caught.value)


def test_byte_order_mark_is_passed_over():
    assert load(b'\xef\xbb\xbf{"asset": {"version": "2.0"}}', "model.gltf").instances == ()


@pytest.mark.parametrize("uri, problem", [
    ("data:application/octet-stream;base64,!!!", "base64"), ("data:;base64", "no data"),
    ("data:;base64,AAAA", "3")])
def test_bad_data_uris(uri, problem):
    builder = GltfBuilder(buffers=[{"byteLength": 36, "uri": uri}])
    builder.node(mesh=builder.triangle())
    with pytest.raises(InputError, match=rf"buffers\[0\].*{problem}"):
        builder.load()


@pytest.mark.parametrize("padding", [b" ", b"\0"])
def test_the_json_of_a_glb_may_be_padded_by_nul(padding):
    builder = GltfBuilder()
    builder.node(mesh=builder.triangle(), name="x" * 1)
    for _ in range(4):  # one length of four needs no padding
        builder.json["nodes"][0]["name"] += "x"
        data = builder.glb()
        length = int.from_bytes(data[12:16], "little")
        text = data[20:20 + length].rstrip(b" ")
        padded = data[:20] + text + padding * (length - len(text)) + data[20 + length:]
        assert load(padded, "model.glb").triangle_count == 1
