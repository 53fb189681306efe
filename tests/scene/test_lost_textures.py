"""A texture that is missing or broken costs that texture: its factor is used alone, and a line says so."""

from __future__ import annotations

import re

import numpy as np
import pytest
from command_line import runner
from gltf_builder import GltfBuilder, png_bytes
from images import noise

import viewer
from viewer.errors import InputError
from viewer.jobs.model_renderer import ModelRenderer
from viewer.scene.environment_files import load_environment
from viewer.scene.load import load_scene
from viewer.scene.scene import Scene

RED = (0.8, 0.1, 0.1, 1.0)
SIZE = (24, 24)


def quad(maps: dict[str, dict] | None = None, **top_level) -> GltfBuilder:
    """A red square from -1 to 1, with `maps` of a glTF material."""
    maps = maps or {}
    base = {"baseColorFactor": RED, "metallicFactor": 0.0, "roughnessFactor": 0.6}
    base |= {key: maps[key] for key in ("baseColorTexture", "metallicRoughnessTexture") if key in maps}
    others = {key: value for key, value in maps.items() if key not in base}
    builder = GltfBuilder(materials=[{"pbrMetallicRoughness": base, **others}], **top_level)
    corners = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]])
    attributes = {"POSITION": builder.accessor(corners), "NORMAL": builder.accessor([[0, 0, 1]] * 4),
                  "TEXCOORD_0": builder.accessor((corners[:, :2] + 1) / 2)}
    builder.node(mesh=builder.mesh(attributes, indices=builder.accessor([0, 1, 2, 0, 2, 3], "uint16"), material=0))
    return builder


def with_garbage(png: bytes) -> bytes:
    """A whole header, and pixels that are not what zlib wrote."""
    begin = png.index(b"IDAT") + 20
    return png[:begin] + b"\xff" * 100 + png[begin + 100:]


BROKEN = with_garbage(png_bytes(noise(16, 16, 3)))


def broken_at_decoding() -> GltfBuilder:
    builder = quad({"baseColorTexture": {"index": 0}, "metallicRoughnessTexture": {"index": 0},
                    "occlusionTexture": {"index": 0}, "normalTexture": {"index": 0}, "emissiveTexture": {"index": 0}},
                   textures=[{"source": 0}])
    builder.json["images"] = [{"bufferView": builder.view(BROKEN), "mimeType": "image/png"}]
    return builder


def picture(scene: Scene, mode: str) -> np.ndarray:
    scene = scene.relit(environment=load_environment("furnace"))
    camera = viewer.Camera.look_at((0, 0, 3), (0, 0, 0))
    return viewer.render(scene, SIZE, camera, mode=mode, background="none", **{"spp": 4} if mode == "path" else {}).srgb


@pytest.mark.parametrize("image, problem", [
    ({"uri": "gone.png"}, "no such file: 'gone.png'"), ({"uri": ""}, "not a file name"),
    ({"uri": "empty.png"}, r"empty\.png: is not an image"), ({"uri": "page.png"}, r"page\.png: is not an image"),
    ({"uri": "folder"}, "is a folder"), ({"uri": "data:image/png;base64,!!!"}, "not valid base64"),
    ({"bufferView": 99}, r"images\[0\]\.bufferView: index 99"), ({}, r"images\[0\]\.bufferView: is missing"),
])
@pytest.mark.parametrize("key", ["baseColorTexture", "occlusionTexture"])
def test_an_image_that_cannot_be_opened_costs_its_texture(tmp_path, image, problem, key):
    (tmp_path / "empty.png").touch()
    (tmp_path / "page.png").write_text("<html>404</html>")
    (tmp_path / "folder").mkdir()
    path = tmp_path / "quad.glb"
    path.write_bytes(quad({key: {"index": 0}}, images=[image], textures=[{"source": 0}]).glb())
    scene = load_scene(path)
    [line] = scene.warnings
    assert line.startswith("materials[0]") and line.endswith("; the texture is left out")
    assert re.search(problem, line)
    assert scene.materials[0].base_color == RED
    assert scene.materials[0].base_color_texture is None and scene.materials[0].occlusion_texture is None


@pytest.mark.parametrize("uri", ["../secret.png", "/etc/passwd", "%2e%2e/secret.png", "http://example.org/a.png"])
def test_a_file_outside_of_the_models_folder_is_refused(tmp_path, uri):
    (tmp_path / "in").mkdir()
    (tmp_path / "secret.png").write_bytes(png_bytes(noise(2, 2, 3)))
    path = tmp_path / "in" / "quad.glb"
    path.write_bytes(quad({"baseColorTexture": {"index": 0}}, images=[{"uri": uri}], textures=[{"source": 0}]).glb())
    with pytest.raises(InputError, match=r"images\[0\]\.uri: "):
        load_scene(path)


@pytest.mark.parametrize("mode", ["pbr", "phong", "path"])
def test_an_image_that_does_not_decode_leaves_the_factors(mode):
    scene = broken_at_decoding().load()
    assert not scene.all_warnings  # nobody has looked yet
    with pytest.warns(UserWarning, match=r"memory\.glb: images\[0\]: .*the texture is left out"):
        found = picture(scene, mode)
    expected = picture(quad().load(), mode)
    assert expected[12, 12, 0] > 2 * expected[12, 12, 1] > 0
    np.testing.assert_allclose(found.astype(int), expected, atol=2)
    assert len(scene.all_warnings) >= 1


def test_the_command_line_says_it_once_for_each_image(tmp_path, capsys):
    path = tmp_path / "quad.glb"
    path.write_bytes(broken_at_decoding().glb())
    run = runner(capsys)
    for arguments in (["render", path, "-o", tmp_path / "quad.png", "--size", "16"], ["info", path]):
        outcome = run(*arguments)
        assert outcome.status == 0
        [line] = outcome.err.splitlines()
        assert line.startswith(f"{path}: warning: {path}: images[0]: cannot be decoded: ")
    assert f"warnings:\n  - {path}: images[0]: cannot be decoded: " in outcome.out


def test_the_command_line_says_it_once_when_other_threads_decode_meanwhile(tmp_path, capsys, monkeypatch):
    """As they do where a model is loaded while another one is drawn."""
    path, warn = tmp_path / "quad.glb", ModelRenderer._warn
    path.write_bytes(broken_at_decoding().glb())

    def warn_and_decode(self, model, scene):
        warn(self, model, scene)
        for image in scene.images:
            image.decode()

    monkeypatch.setattr(ModelRenderer, "_warn", warn_and_decode)
    [line] = runner(capsys)("render", path, "-o", tmp_path / "quad.png", "--size", "16").err.splitlines()
    assert line.startswith(f"{path}: warning: {path}: images[0]: cannot be decoded: ")


def test_of_an_obj_a_broken_image_leaves_the_factors_and_the_other_map(tmp_path):
    (tmp_path / "a.obj").write_text("mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\n"
                                    "usemtl m\nf 1/1 2/2 3/3\n")
    (tmp_path / "a.mtl").write_text("newmtl m\nPr 0.5\nPm 1\nmap_Pr bad.png\nmap_Pm good.png\nmap_Kd bad.png\n"
                                    "norm bad.png\n")
    (tmp_path / "bad.png").write_bytes(BROKEN)
    (tmp_path / "good.png").write_bytes(png_bytes(np.full((16, 16, 3), 51, np.uint8)))
    scene = load_scene(tmp_path / "a.obj")
    [material] = scene.materials
    assert (material.perceptual_roughness, material.metallic) == (0.5, 1.0)
    assert material.metallic_roughness_texture.image.decode()[3, 3].tolist() == [255, 255, 51]
    assert material.normal_texture.image.decode()[3, 3].tolist() == [128, 128, 255, 255]
    assert material.base_color_texture.image.decode()[3, 3].tolist() == [255] * 4
    assert any("bad.png" in line and "left out" in line for line in scene.warnings)
    assert all("bad.png" in line for line in scene.all_warnings)
