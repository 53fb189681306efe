"""Arrays that come in from Python are converted, or refused in one line; what a scene holds cannot be changed."""

from __future__ import annotations

import copy
import math
import multiprocessing
import pickle

import numpy as np
import pytest
from images import image_of, noise
from test_lost_textures import quad

import viewer
from viewer.scene.environment import Environment
from viewer.scene.environment_files import load_environment
from viewer.scene.material import Texture

POSITIONS = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], np.float32)
INDICES = np.array([0, 1, 2, 0, 2, 3], np.uint32)
FACING = np.array([[0, 0, 1]] * 4, np.float32)
CAMERA = viewer.Camera.look_at((0, 0, 3), (0, 0, 0))


def square(**changes) -> viewer.Mesh:
    return viewer.Mesh(**{"name": "square", "positions": POSITIONS, "material": 0, "indices": INDICES,
                          "normals": FACING} | changes)


def scene(mesh: viewer.Mesh, material: viewer.Material | None = None) -> viewer.Scene:
    return viewer.Scene("square", (mesh,), (material or viewer.Material(metallic=0.0),),
                        (viewer.Instance(0, np.eye(4)),), environment=load_environment("furnace"))


def picture(shown: viewer.Scene) -> np.ndarray:
    return viewer.render(shown, (16, 16), CAMERA, background="none").srgb


@pytest.mark.parametrize("changes", [
    {"indices": INDICES.astype(dtype)} for dtype in (np.int64, np.int32, np.uint16, np.uint8)
] + [
    {"indices": INDICES.tolist()}, {"positions": POSITIONS.tolist()}, {"positions": POSITIONS.astype(np.float64)},
    {"positions": POSITIONS.astype(np.int8)}, {"positions": np.repeat(POSITIONS, 2, axis=0)[::2]},
    {"positions": np.asfortranarray(POSITIONS)}, {"positions": POSITIONS.astype(">f4")},
    {"normals": FACING.astype(np.float64)}, {"colors": np.ones((4, 4))}, {"colors": np.ones((4, 3))},
    {"colors": np.full((4, 4), 255, np.uint8)}, {"colors": np.full((4, 3), 65535, np.uint16)},
    {"uvs": [np.zeros((4, 2))]},
], ids=lambda changes: "-".join(f"{k}-{getattr(v, 'dtype', type(v).__name__)}" for k, v in changes.items()))
def test_what_means_the_same_gives_the_same_arrays(changes):
    expected = square(**({"colors": np.ones((4, 4), np.float32)} if "colors" in changes else {}))
    found = square(**changes)
    for name in ("positions", "indices", "normals", "colors"):
        one, other = getattr(found, name), getattr(expected, name)
        assert np.array_equal(one, other) if other is not None else one is None
        assert one is None or (one.dtype == other.dtype and one.flags.c_contiguous and not one.flags.writeable)


def test_integer_indices_draw_the_same_picture():
    expected = picture(scene(square()))
    assert (expected[..., 3] > 0).sum() > 50
    assert np.array_equal(picture(scene(square(indices=INDICES.astype(np.int64)))), expected)


@pytest.mark.parametrize("make, words", [
    (lambda: square(positions=POSITIONS[:, :2]), r"Mesh\.positions is \(4, 2\) float32, not \(N, 3\) float32"),
    (lambda: square(positions=[[1, 2, 3], [4, 5]]), r"Mesh\.positions: list is no array of numbers"),
    (lambda: square(positions=POSITIONS * np.nan), r"Mesh\.positions \(4, 3\) float32: holds NaN"),
    (lambda: square(positions=POSITIONS.astype(np.float64) * 1e300), r"Mesh\.positions \(4, 3\) float64: holds NaN or"),
    (lambda: square(positions=POSITIONS + 1j), r"Mesh\.positions: ndarray is no array of numbers"),
    (lambda: square(positions="abc"), r"Mesh\.positions: str is no array"),
    (lambda: square(indices=INDICES.reshape(2, 3)), r"Mesh\.indices is \(2, 3\) uint32, not \(N,\) uint32"),
    (lambda: square(indices=INDICES.astype(float)), r"Mesh\.indices is \(6,\) float64, not whole numbers"),
    (lambda: square(indices=[0, 1, -1]), r"Mesh\.indices .*-1 to 1 do not fit uint32"),
    (lambda: square(indices=[0, 1, 1 << 32]), r"Mesh\.indices .*do not fit uint32"),
    (lambda: square(indices=[0, 1, 4]), r"Mesh\.indices: index 4, but there are 4 positions"),
    (lambda: square(normals=FACING[:3]), r"Mesh\.normals is \(3, 3\) float32, not \(4, 3\)"),
    (lambda: square(colors=np.ones((4, 2))), r"Mesh\.colors is \(4, 2\)"),
    (lambda: square(colors=np.ones(4)), r"Mesh\.colors is \(4,\)"),
    (lambda: square(uvs=(np.zeros((4, 3)),)), r"Mesh\.uvs\[0\] is \(4, 3\)"),
    (lambda: square(topology="quads"), r"Mesh\.topology is 'quads', not one of triangles, lines, points"),
    (lambda: viewer.Instance(0, np.eye(3)), r"Instance\.transform is \(3, 3\)"),
    (lambda: viewer.Scene("s", (square(material=1),), (viewer.Material(),)),
     r"Scene\.meshes\[0\]: material 1, but only 0 exists"),
    (lambda: viewer.Scene("s", instances=(viewer.Instance(0, np.eye(4)),)),
     r"Scene\.instances\[0\]: mesh 0, but there are none"),
    (lambda: viewer.Scene("s", meshes=None), r"Scene\.meshes is of type NoneType, not a tuple of meshes"),
    (lambda: viewer.Scene("s", materials=["red"]), r"Scene\.materials\[0\] is of type str, not a Material"),
    (lambda: viewer.Scene("s", instances=[3]), r"Scene\.instances\[0\] is of type int, not an Instance"),
    (lambda: viewer.Scene("s").relit(lights=viewer.Light("point")), r"Scene\.lights is of type Light, not a tuple of"),
    (lambda: viewer.Scene("s").relit(environment="studio"), r"Scene\.environment is of type str, not an Environment"),
    (lambda: viewer.Scene("s").framing_camera(0), r"aspect is 0, not above 0"),
    (lambda: viewer.Scene("s").framing_camera("4:3"), r"aspect is of type str, not a number"),
    (lambda: viewer.write_cameras("cameras.json", 3), r"frames is of type int, not a list"),
    (lambda: viewer.Camera(np.eye(4) * np.nan), r"Camera\.pose .*holds NaN"),
    (lambda: viewer.Camera(np.eye(4).tolist(), 45), r"Camera\.fov_y is 45, .*in radians: math\.radians\(45\)"),
    (lambda: viewer.Camera(np.eye(4), math.nan), r"Camera\.fov_y is nan"),
    (lambda: viewer.Camera(np.eye(4), height=0), r"Camera\.height is 0"),
    (lambda: viewer.Camera.look_at((0, 0, math.nan), (0, 0, 0)), r"eye .*holds NaN"),
    (lambda: viewer.Camera.look_at((0, 0), (0, 0, 0)), r"eye is \(2,\)"),
    (lambda: viewer.Camera.orbit((0, 0, 0), math.inf), r"distance is inf, not a finite number"),
    (lambda: viewer.Light("sun"), r"Light\.kind is 'sun'"),
    (lambda: viewer.Light("point", intensity=math.nan), r"Light\.intensity is nan"),
    (lambda: viewer.Light("point", (1, 1)), r"Light\.color is \(2,\)"),
    (lambda: viewer.Light("point", position=(1, math.inf, 1)), r"Light\.position .*holds NaN"),
    (lambda: viewer.Light("spot", direction=(0, 0, 0)), r"Light\.direction is 0, 0, 0"),
    (lambda: viewer.Light("point", intensity="1"), r"Light\.intensity is of type str, not a number"),
    (lambda: viewer.Light("point", range="1"), r"Light\.range is of type str, not a number"),
    (lambda: Environment("e", np.ones((4, 8, 3)), intensity="1"), r"Environment\.intensity is of type str, not a num"),
    (lambda: viewer.Material(base_color=(1, 0, 0)), r"Material\.base_color is \(3,\) int64, not \(4,\) float64"),
    (lambda: viewer.Material(base_color=(255, 0, 0, 255)), r"Material\.base_color is \(255\.0, .*, not from 0 to 1"),
    (lambda: viewer.Material(base_color="red"), r"Material\.base_color: str is no array of numbers"),
    (lambda: viewer.Material(metallic="1"), r"Material\.metallic is of type str, not a number"),
    (lambda: viewer.Material(perceptual_roughness=math.nan), r"Material\.perceptual_roughness is nan, not a number"),
    (lambda: viewer.Material(base_color_texture="a.png"), r"Material\.base_color_texture is of type str, not a Text"),
    (lambda: viewer.Material(alpha_mode="x"), r"Material\.alpha_mode is 'x', not one of opaque, mask, blend"),
    (lambda: Environment("e", np.zeros((4, 8))), r"Environment\.source is \(4, 8\)"),
    (lambda: Environment("e", np.full((4, 8, 3), -1.0)), r"Environment\.source .*below 0"),
    (lambda: Environment("e", np.full((4, 8, 3), 3e38)), r"Environment\.source .*3e\+38 is over 1e\+12"),
    (lambda: Environment("e", np.ones((4, 8, 3)), intensity=1e200), r"Environment\.intensity is 1e\+200, .*1e\+18"),
    (lambda: viewer.Material(emissive=(0, 3e38, 0)), r"Material\.emissive is .*3e\+38.*, not from 0 to 1e\+30"),
    (lambda: viewer.Material(emissive=(0, 1e200, 0)), r"Material\.emissive is .*1e\+200.*, not from 0 to 1e\+30"),
    (lambda: viewer.Material(emissive=(0, np.nan, 0)), r"Material\.emissive \(3,\) float64: holds NaN"),
])
def test_what_has_no_meaning_is_one_line(make, words):
    with pytest.raises(viewer.UsageError, match=words) as caught:
        make()
    assert "\n" not in str(caught.value)


def test_a_colour_of_a_material_may_be_an_array():
    assert viewer.Material(base_color=np.array([1, 0, 0, 1])) == viewer.Material(base_color=(1.0, 0.0, 0.0, 1.0))


def test_what_a_scene_holds_cannot_be_changed():
    positions = POSITIONS.copy()
    mesh = square(positions=positions)
    positions[:] = 7  # the mesh has its own
    assert np.array_equal(mesh.positions, POSITIONS)
    for array in (mesh.positions, mesh.indices, viewer.Instance(0, np.eye(4)).transform, CAMERA.pose):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 1


def test_a_read_only_array_is_not_copied():
    positions = POSITIONS.copy()
    positions.flags.writeable = False
    assert square(positions=positions).positions is positions


@pytest.mark.parametrize("twin", [copy.deepcopy, lambda thing: pickle.loads(pickle.dumps(thing))],
                         ids=["deepcopy", "pickle"])
def test_a_copy_of_a_scene_shows_the_same(twin):
    picture_of = image_of(noise(8, 8, 3))
    textured = viewer.Material(metallic=0.0, base_color_texture=Texture(picture_of))
    shown = scene(square(uvs=(POSITIONS[:, :2],)), textured)
    found = twin(shown)
    assert found.materials[0].base_color_texture.image.data == picture_of.data
    assert not found.meshes[0].positions.flags.writeable and not found.instances[0].transform.flags.writeable
    assert np.array_equal(picture(found), picture(shown))


def test_a_scene_from_files_goes_to_another_process(tmp_path):
    textured = quad({"baseColorTexture": {"index": 0}})
    textured.texture(noise(8, 8, 3))
    (tmp_path / "quad.glb").write_bytes(textured.glb())
    header = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 4\n"
    (tmp_path / "sky.hdr").write_bytes(header + bytes([128, 64, 32, 129] * 8))
    shown = viewer.load(tmp_path / "quad.glb", tmp_path / "sky.hdr")
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        found = pool.apply(viewer.render, (shown, (16, 16), CAMERA))
    assert np.array_equal(found.srgb, viewer.render(shown, (16, 16), CAMERA).srgb)


def test_a_scene_is_told_in_a_line():
    shown = scene(square())
    assert repr(shown) == "<Scene 'square': 1 meshes, 1 materials, 1 instances, environment 'furnace'>"
    assert repr(shown.meshes[0]) == "<Mesh 'square': triangles, 4 positions, indices, normals>"
    assert repr(viewer.Scene("none")) == "<Scene 'none': empty, environment None>"


def test_a_light_shines_along_a_direction_of_any_length():
    assert viewer.Light("spot", direction=(0, 3, -4)).direction == pytest.approx((0, 0.6, -0.8))
    assert viewer.Light("spot", direction=(1e308, 0, -1e308)).direction == pytest.approx((0.5**0.5, 0, -(0.5**0.5)))
    assert viewer.Light("spot", direction=(0, 1, 0)).direction == (0, 1, 0)
