import struct

import numpy as np
import pytest
from PIL import Image

from viewer.errors import InputError
from viewer.scene.color import srgb_to_linear
from viewer.scene.load import load_scene

OBJ = """mtllib m.mtl
v 0 0 0
v 1 0 0
v 0 1 0
v 1 1 0
vt 0.25 0.25
vt 1 0
vt 0 1
vn 0 0 1
usemtl red
f 1/1/1 2/2/1 3/3/1
usemtl blue
f 2/2/1 4/1/1 3/3/1
"""


@pytest.fixture
def write(tmp_path):
    def write(name: str, content: str | bytes):
        path = tmp_path / name
        path.write_bytes(content.encode() if isinstance(content, str) else content)
        return path
    return write


def by_name(scene):
    return {scene.materials[mesh.material].name: (mesh, scene.materials[mesh.material]) for mesh in scene.meshes}


def test_obj_with_materials(write, tmp_path):
    Image.new("RGB", (2, 2), (1, 2, 3)).save(tmp_path / "a b.png")
    write("m.mtl", "newmtl red\nKd 1 0.5 0\nKs 1 1 1\nNs 30\nd 0.5\nKe 0 0 1\nmap_Kd -s 1 1 1 -clamp on a b.png\n"
                   "norm -bm 0.5 a b.png\nnewmtl blue\nKd 0 0 1\nTr 0.25\n")
    scene = load_scene(write("m.obj", OBJ))
    red_mesh, red = by_name(scene)["red"]
    _, blue = by_name(scene)["blue"]
    np.testing.assert_allclose(red.base_color, [1, 0.214041, 0, 0.5], atol=1e-6)  # 0.5 in sRGB
    assert red.shininess == 30 and red.perceptual_roughness == pytest.approx((2 / 32) ** 0.25)
    assert red.metallic == 0 and red.emissive == (0, 0, 1) and red.alpha_mode == "blend" and red.double_sided
    assert red.base_color_texture.image.width == 2 and red.base_color_texture.sampler.wrap_s == "clamp"
    assert red.normal_scale == 0.5 and red.normal_texture.image.name == red.base_color_texture.image.name
    assert blue.base_color == (0, 0, 1, 0.75) and blue.shininess is None
    first = np.flatnonzero((red_mesh.positions == 0).all(axis=1))[0]
    np.testing.assert_allclose(red_mesh.uvs[0][first], [0.25, 0.75])  # v turned downwards
    np.testing.assert_array_equal(red_mesh.normals, [[0, 0, 1]] * 3)
    assert red_mesh.tangents.shape == (3, 4) and not scene.warnings


def test_height_maps_are_left_out_with_a_warning(write, tmp_path):
    Image.new("L", (2, 2)).save(tmp_path / "grey.png")
    write("m.mtl", "newmtl red\nmap_Bump grey.png\n")
    scene = load_scene(write("m.obj", OBJ))
    assert by_name(scene)["red"][1].normal_texture is None and "height map" in scene.warnings[0]


@pytest.mark.parametrize("library", ["../m.mtl", "/etc/hostname", "missing.mtl", "http://localhost/m.mtl"])
def test_material_files_elsewhere_are_left_out(write, library):
    scene = load_scene(write("m.obj", OBJ.replace("m.mtl", library)))
    assert scene.triangle_count == 2 and "left out" in scene.warnings[0]


FOLD = """v 0 0 0
v 0 1 0
v 1 0 0
v 1 1 0
v {x} 0 {z}
v {x} 1 {z}
{first}
f 1 3 4 2
{second}
f 3 5 6 4
"""


@pytest.mark.parametrize("first, second, angle, is_smooth", [
    ("s 1", "", 90, True), ("s 7 # seven", "s 7", 90, True), ("s on", "", 90, True), ("s 1", "s 2", 20, False),
    ("s off", "", 20, False), ("s 0", "s 1", 20, False), ("", "s 1", 20, False), ("s", "", 20, False),
    ("", "", 20, True), ("", "", 90, False),
])
def test_smoothing_groups(write, first, second, angle, is_smooth):
    """Two quads that meet at an angle. Without groups an edge is sharp from 45 degrees on."""
    x, z = 1 + np.cos(np.radians(angle)), -np.sin(np.radians(angle))
    mesh, = load_scene(write("m.obj", FOLD.format(x=x, z=z, first=first, second=second))).meshes
    edge = mesh.normals[(mesh.positions == (1, 0, 0)).all(axis=1)]
    both = np.array([[0, 0, 1], [np.sin(np.radians(angle)), 0, np.cos(np.radians(angle))]])
    expected = both.sum(axis=0, keepdims=True) / np.linalg.norm(both.sum(axis=0)) if is_smooth else both
    np.testing.assert_allclose(np.sort(edge, axis=0), np.sort(expected, axis=0), atol=1e-6)


def test_normals_of_the_file_come_before_smoothing_groups(write):
    text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 1 0\ns off\nf 1//1 2//1 3//1\n"
    np.testing.assert_array_equal(load_scene(write("m.obj", text)).meshes[0].normals, [[0, 1, 0]] * 3)


def test_smoothing_groups_stay_with_their_triangles(write):
    """Where one is left out, and where a polygon becomes several."""
    text = FOLD.format(x=1, z=-1, first="v nan 0 0\ns 3\nf 1 2 7", second="")
    mesh, = load_scene(write("m.obj", text)).meshes
    assert len(mesh.positions) == 6


def test_indices_that_count_back(write):
    scene = load_scene(write("m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\nv 5 0 0\nv 6 0 0\nv 5 1 0\nf -3 -2 -1\n"))
    assert sorted(set(scene.meshes[0].positions[:, 0].tolist())) == [0, 1, 5, 6]
    assert scene.triangle_count == 2


def test_polygons(write):
    scene = load_scene(write("m.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv -1 0.5 0\nf 1 2 3 4\nf 1 2 3 4 5\n"))
    assert scene.triangle_count == 5


def test_ply_colours_and_points(write):
    header = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n" \
             "property uchar red\nproperty uchar green\nproperty uchar blue\n{}end_header\n"
    rows = "0 0 0 255 0 0\n1 0 0 0 128 0\n0 1 0 0 0 255\n"
    scene = load_scene(write("m.ply", header.format("element face 1\nproperty list uchar int vertex_indices\n") + rows
                             + "3 0 1 2\n"))
    mesh = scene.meshes[0]
    green = mesh.colors[np.flatnonzero(mesh.positions[:, 0] == 1)[0]]
    np.testing.assert_allclose(green, [0, 0.215861, 0, 1], atol=1e-6)
    assert scene.materials[mesh.material].base_color == (1, 1, 1, 1)
    points = load_scene(write("p.ply", header.format("") + rows)).meshes[0]
    assert points.topology == "points" and points.element_count == 3
    np.testing.assert_allclose(points.colors[1], [0, 0.215861, 0, 1], atol=1e-6)


def test_stl_that_begins_with_solid(write):
    triangle = struct.pack("<12fH", 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0)
    scene = load_scene(write("m.stl", b"solid".ljust(80) + struct.pack("<I", 1) + triangle))
    np.testing.assert_array_equal(scene.meshes[0].normals, [[0, 0, 1]] * 3)


def test_off(write):
    scene = load_scene(write("m.off", "OFF\n3 1 0\n0 0 0\n2 0 0\n0 2 0\n3 0 1 2\n"))
    assert scene.triangle_count == 1 and scene.name == "m"
    np.testing.assert_array_equal(scene.bounds, [[0, 0, 0], [2, 2, 0]])


@pytest.mark.parametrize("name, content", [
    ("m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"), ("m.xyz", "0 0 0\n1 0 0\n"),
    ("m.off", "OFF\n3 1 0\n0 0 0\n2 0 0\n0 2 0\n3 0 1 2\n"),
    ("m.stl", "solid\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"),
    ("m.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
              "end_header\n0 0 0\n")])
def test_what_has_no_material_is_grey(write, name, content):
    """0.6 in sRGB; a default material of glTF is white (tests/scene/test_gltf_materials.py)."""
    material, = load_scene(write(name, content)).materials
    np.testing.assert_allclose(material.base_color, (*srgb_to_linear(np.full(3, 0.6)), 1), atol=0.005)
    assert material.metallic == 0


@pytest.mark.parametrize("name, content", [
    ("m.obj", "v 0 0 0\nf 1 2 3\n"), ("m.obj", "v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"), ("m.obj", "# nothing\n"),
    ("m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -x\n"),
    ("m.stl", b"\0" * 80 + struct.pack("<I", 100) + b"\0" * 30), ("m.off", "OFF\n1000000000 1 0\n"),
    ("m.ply", "ply\nformat ascii 1.0\nelement vertex 4000000000\nproperty float x\nend_header\n0\n"),
    ("m.ply", "ply\nformat ascii 1.0\nelement vertex 1\n")])
def test_broken_files(write, name, content):
    path = write(name, content)
    with pytest.raises(InputError, match=f"^{path}") as caught:
        load_scene(path)
    assert "\n" not in str(caught.value)
