"""What people met in files of other programs: each with its right value."""

import struct

import numpy as np
import pytest
from PIL import Image

from viewer.errors import InputError
from viewer.scene.load import load_scene

QUAD = "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\n"
TEXTURED = "mtllib m.mtl\n" + QUAD + "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl m\nf 1/1 2/2 3/3 4/4\n"
PLY = "ply\nformat {} 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n{}end_header\n"
FACES = "element face {}\nproperty list uchar int vertex_indices\n"
CORNERS = "-1 -1 0\n1 -1 0\n1 1 0\n-1 1 0\n"
RED, GREEN = (1, 0, 0, 1), (0, 1, 0, 1)


@pytest.fixture
def load(tmp_path):
    def load(name: str, content: str | bytes, **others: str | bytes):
        for key, text in {name: content, **{k.replace("_", "."): v for k, v in others.items()}}.items():
            (tmp_path / key).write_bytes(text.encode() if isinstance(text, str) else text)
        return load_scene(tmp_path / name)
    return load


def stl(*attributes: int, header: bytes = b"", count: int | None = None, behind: bytes = b"") -> bytes:
    facet = struct.pack("<12f", 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0)
    count = len(attributes) if count is None else count
    return header.ljust(80) + struct.pack("<I", count) + b"".join(
        facet + struct.pack("<H", a) for a in attributes) + behind


ASCII_STL = b"solid %s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n" \
            b"endsolid %s\n"


@pytest.mark.parametrize("text", [
    QUAD + "f\t1 2 3 4\n", QUAD + "f 1\t2\t3\t4", QUAD + "  f 1 2 3 4\n", QUAD.replace("v", "  v") + "f 1 2 3 4\n",
    QUAD.replace("v ", "v\t") + "f -4 -3 -2 -1\n", QUAD.replace("0\n", "0 # a\n") + "f 1 2 3 4 # quad\n",
    QUAD + "vt 0 0 # x\nvt 1 0\nf 1/1 2/2 3/1 4/2\n", (QUAD + "f 1 2 3 4\n").replace("\n", "\r"),
    (QUAD + "f 1 2 3 4\n").replace("\n", "\r\n"), QUAD + "f 1 2 \\\n3 4\n", QUAD + "f 1// 2// 3// 4//\n",
    QUAD + "vn 0 0 1\nf 1//1 2//1 3//1 4//1\n"])
def test_every_way_to_write_an_obj(load, text):
    scene = load("m.obj", text)
    assert scene.triangle_count == 2 and not scene.warnings
    np.testing.assert_array_equal(scene.bounds, [[-1, -1, 0], [1, 1, 0]])
    np.testing.assert_array_equal(scene.meshes[0].normals, [[0, 0, 1]] * 4)


@pytest.mark.parametrize("coding", ["utf-8", "utf-8-sig", "latin-1", "utf-16"])
def test_text_in_any_encoding(load, coding):
    name = "Grün"
    scene = load("m.obj", TEXTURED.replace("usemtl m", f"o Bügel\nusemtl {name}").encode(coding),
                 m_mtl=f"newmtl {name}\nKd 0 1 0\n".encode(coding))
    assert scene.materials[0].base_color == GREEN and scene.materials[0].name == name
    if coding == "latin-1":
        assert load("m.ply", (PLY.format("ascii", 4, FACES.format(1)) + CORNERS + "4 0 1 2 3\n").replace(
            "element face", "comment ä\nelement face").encode(coding)).triangle_count == 2
        assert load("m.off", b"OFF # \xe4\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n").triangle_count == 1
    if coding in ("utf-8", "latin-1"):
        assert load("m.stl", ASCII_STL % (name.encode(coding), b"")).meshes[0].name == name


def test_concave_polygons_keep_their_notch(load):
    points = "0 0 0\n4 0 0\n4 4 0\n0 4 0\n0 3 0\n3 3 0\n3 1 0\n0 1 0\n"
    ply = PLY.format("ascii", 8, FACES.format(1)) + points + "8 0 1 2 3 4 5 6 7\n"
    obj = "".join(f"v {line}\n" for line in points.splitlines()) + "f 1 2 3 4 5 6 7 8\n"
    for name, text in [("c.ply", ply), ("c.off", f"OFF 8 1 0\n{points}8 0 1 2 3 4 5 6 7\n"), ("c.obj", obj)]:
        mesh = load(name, text).meshes[0]
        corners = mesh.positions[mesh.indices].reshape(-1, 3, 3)
        areas = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])[:, 2] / 2
        assert areas.min() >= 0 and areas.sum() == 10


@pytest.mark.parametrize("kind", ["obj", "ply"])
def test_coordinates_far_off_keep_their_digits(load, kind):
    center = np.array([408201.0, 35.0, 4080928.0])
    points = np.array([[0, 0, 0], [1e-4, 0, 0], [0, 1, 0.125]]) + center
    if kind == "obj":
        data = "".join("v {:.6f} {:.6f} {:.6f}\n".format(*p) for p in points).encode() + b"f 1 2 3\n"
    else:
        header = PLY.format("binary_little_endian", 3, FACES.format(1)).replace("float", "double")
        data = header.encode() + points.tobytes() + struct.pack("<B3i", 3, 0, 1, 2)
    scene = load(f"m.{kind}", data)
    mesh, instance = scene.meshes[0], scene.instances[0]
    world = mesh.positions[mesh.indices] + instance.transform[:3, 3]
    np.testing.assert_allclose(world, points, atol=1e-7, rtol=0)


def test_unfinished_points_and_triangles_are_left_out(load):
    scene = load("m.ply", PLY.format("ascii", 4, "") + "0 0 0\nnan nan nan\n1 0 0\n-nan nan nan\n")
    assert scene.meshes[0].element_count == 2 and scene.warnings[0].startswith("2 points")
    scene = load("m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv nan 0 0\nv inf 0 0\nf 1 2 3\nf 1 2 4\n")
    assert scene.triangle_count == 1 and scene.warnings[0].startswith("1 triangle")
    np.testing.assert_array_equal(scene.bounds, [[0, 0, 0], [1, 1, 0]])


def test_lines_and_points_of_obj(load):
    scene = load("m.obj", QUAD + "l 1 2 3 4 1\np 2 3\n")
    lines, points = scene.meshes
    assert lines.topology == "lines" and lines.indices.tolist() == [0, 1, 1, 2, 2, 3, 3, 0]
    assert points.topology == "points" and points.positions[points.indices, 0].tolist() == [1, 1]
    assert not scene.warnings


def test_colours_of_obj_vertices_and_curves_without_support(load):
    scene = load("m.obj", QUAD.replace("0\n", "0 1 0 0\n") + "curv2 1 2\ncurv2 3 4\nf 1 2 3 4\n")
    np.testing.assert_array_equal(scene.meshes[0].colors, [RED] * 4)
    assert scene.warnings == ("curv2: not supported; 2 of these lines left out",)


def test_several_material_files(load):
    scene = load("m.obj", 'mtllib a.mtl "b.mtl"\n' + QUAD + "usemtl red\nf 1 2 3\nusemtl green # here\nf 1 3 4\n",
                 a_mtl="newmtl red\nKd 1 0 0\n", b_mtl="newmtl green\n\tKd 0 1 0\n")
    assert [m.base_color for m in scene.materials] == [RED, GREEN] and not scene.warnings


@pytest.mark.parametrize("statement", ["map_Kd -s\t1 1 1\tt.png", "map_Kd  -s 1 1 1  t.png", "map_Kd t.png # diffuse",
                                       'map_Kd "t.png"', "\tMAP_KD\tt.png  ", "map_Kd -mm 0 1 t.png"])
def test_ways_to_name_a_texture(load, tmp_path, statement):
    Image.new("RGB", (2, 2)).save(tmp_path / "t.png")
    scene = load("m.obj", TEXTURED, m_mtl=f"newmtl m\n{statement}\nd -halo 0.5\n")
    material = scene.materials[0]
    assert material.base_color_texture.transform is None and not scene.warnings
    assert material.base_color[3] == 0.5 and material.alpha_mode == "blend"


@pytest.mark.parametrize("options, uv, expected", [
    ("-s 2 2 1", (1, 0.25), (2, 0.5)), ("-o 0.5 0 0", (0.25, 0.25), (0.75, 0.25)),
    ("-s 2 4 -o 0 0.5", (0, 0.25), (0, 1.5)), ("-s 3", (1, 1), (3, 1))])
def test_scale_and_offset_of_textures(load, tmp_path, options, uv, expected):
    """With v upwards, as MTL has it."""
    Image.new("RGB", (2, 2)).save(tmp_path / "t.png")
    matrix = load("m.obj", TEXTURED, m_mtl=f"newmtl m\nmap_Kd {options} t.png\n").materials[0] \
        .base_color_texture.transform.matrix()
    u, v = matrix[:, :2] @ (uv[0], 1 - uv[1]) + matrix[:, 2]
    np.testing.assert_allclose((u, 1 - v), expected)


def test_roughness_and_metallic(load, tmp_path):
    material = load("m.obj", TEXTURED, m_mtl="newmtl m\nNs 250\nPr 0.2\nPm 1.0\nPs 0\n").materials[0]
    assert (material.metallic, material.perceptual_roughness, material.shininess) == (1, 0.2, None)
    Image.new("L", (2, 2), 51).save(tmp_path / "r.png")
    Image.new("RGB", (4, 4), (0, 102, 0)).save(tmp_path / "m.png")
    material = load("m.obj", TEXTURED, m_mtl="newmtl m\nmap_Pr r.png\nmap_Pm -imfchan g m.png\n").materials[0]
    assert (material.metallic, material.perceptual_roughness) == (1, 1)
    assert material.metallic_roughness_texture.image.decode("GB")[0, 0].tolist() == [51, 102]
    scene = load("m.obj", TEXTURED, m_mtl="newmtl m\nPc 0.5\nmap_d r.png\n")
    assert scene.warnings == ("m.mtl: map_d is not supported; it is left out",
                              "m.mtl: pc is not supported; it is left out")


@pytest.mark.parametrize("data, warns", [
    (stl(0, 0, behind=b"x" * 37), True), (stl(0, 0, count=3), True), (stl(0, 0, count=1), True),
    (stl(0, 0, header=b"solid", behind=b"x" * 37), True), (stl(0, 0, header=b"B\xfcgel"), False)])
def test_binary_stl_with_more_or_less_than_declared(load, data, warns):
    scene = load("m.stl", data)
    assert scene.triangle_count == 2 and bool(scene.warnings) == warns


@pytest.mark.parametrize("header, attributes", [(b"COLOR=\xff\0\0\xff", (0x8000, 31 << 5)),
                                                (b"", (0x8000 | 31 << 10, 0x8000 | 31 << 5))])
def test_colours_of_binary_stl(load, header, attributes):
    np.testing.assert_array_equal(load("m.stl", stl(*attributes, header=header)).meshes[0].colors[::3], [RED, GREEN])


def test_ascii_stl_of_several_solids_with_any_name(load):
    scene = load("m.stl", ASCII_STL % (b"vertex_block", b"") + (ASCII_STL % (b"b", b"")).upper())
    assert [m.name for m in scene.meshes] == ["vertex_block", "B"] and scene.triangle_count == 2


@pytest.mark.parametrize("order", "<>")
def test_binary_ply_of_mixed_faces_with_bytes_behind(load, order):
    name = {"<": "binary_little_endian", ">": "binary_big_endian"}[order]
    header = PLY.format(name, 4, "property ushort red\nproperty ushort green\nproperty ushort blue\n" + FACES.format(2))
    data = header.encode() + b"".join(struct.pack(f"{order}3f3H", *map(float, line.split()), 65535, 0, 0)
                                      for line in CORNERS.splitlines())
    data += struct.pack(f"{order}B4i", 4, 0, 1, 2, 3) + struct.pack(f"{order}B3i", 3, 0, 1, 2)
    for behind in (b"", b"\n\n1234567"):
        scene = load("m.ply", data + behind)
        assert scene.triangle_count == 3
        np.testing.assert_array_equal(scene.bounds, [[-1, -1, 0], [1, 1, 0]])
        np.testing.assert_array_equal(scene.meshes[0].colors[0], RED)
    with pytest.raises(InputError, match="face: 2 are declared"):
        load("m.ply", data[:-3])


def test_ply_faces_with_colours(load):
    header = PLY.format("ascii", 4, FACES.format(2) + "property uchar red\nproperty uchar green\nproperty uchar blue\n")
    mesh = load("m.ply", header + CORNERS + "4 0 1 2 3 255 0 0\n3 0 1 2 0 255 0\n").meshes[0]
    np.testing.assert_array_equal(mesh.colors[mesh.indices][::3], [RED, RED, GREEN])


def test_ply_faces_with_texture_coordinates(load, tmp_path):
    Image.new("RGB", (2, 2)).save(tmp_path / "t.png")
    header = PLY.format("ascii", 4, FACES.format(1) + "property list uchar float texcoord\n")
    text = header.replace("1.0\n", "1.0\ncomment TextureFile t.png\n", 1) + CORNERS + "4 0 1 2 3 8 0 0 1 0 1 1 0 1\n"
    scene = load("m.ply", text)
    mesh = scene.meshes[0]
    assert scene.materials[0].base_color_texture.image.width == 2
    np.testing.assert_allclose(mesh.uvs[0] * (2, -2) + (-1, 1), mesh.positions[:, :2])


@pytest.mark.parametrize("end", ["\r", "\r\n"])
def test_ply_lines_that_end_in_cr(load, end):
    text = (PLY.format("ascii", 4, FACES.format(1)) + CORNERS + "4 0 1 2 3\n").replace("\n", end)
    assert load("m.ply", text).triangle_count == 2
    binary = PLY.format("binary_little_endian", 3, "").replace("\n", end).encode()
    points = load("m.ply", binary + np.arange(9, dtype="<f4").tobytes()).meshes[0]
    np.testing.assert_array_equal(points.positions, np.arange(9).reshape(3, 3))


def test_ply_edges_and_other_elements(load):
    extra = "element edge 1\nproperty int vertex1\nproperty int vertex2\nelement camera 1\nproperty float view\n"
    scene = load("m.ply", PLY.format("ascii", 4, extra) + CORNERS + "0 2\n1.5\n")
    assert scene.meshes[0].topology == "lines" and scene.warnings == ("element camera: not supported; it is left out",)


@pytest.mark.parametrize("keyword, row, expected", [
    ("COFF", "255 0 0 255", RED), ("COFF", "0 1 0", GREEN), ("NCOFF", "0 0 1 1 0 0", RED), ("NOFF", "0 0 1", None)])
def test_off_with_attributes(load, keyword, row, expected):
    text = f"{keyword}\n4 1 0\n" + CORNERS.replace("\n", f" {row}\n") + "4 0 1 2 3\n"
    mesh = load("m.off", text).meshes[0]
    assert (mesh.colors is None) if expected is None else (mesh.colors == expected).all()
    np.testing.assert_array_equal(mesh.normals, [[0, 0, 1]] * 4)


def test_off_faces_with_colours(load):
    mesh = load("m.off", "OFF\n4 2 0\n" + CORNERS + "3 0 1 2 255 0 0\n3 0 2 3 0 255 0\n").meshes[0]
    np.testing.assert_array_equal(mesh.colors[mesh.indices][::3], [RED, GREEN])


@pytest.mark.parametrize("name, content, problem", [
    ("m.obj", QUAD + "f 1 2 x\n", r"line 5 \(f\): 'x' is not an integer"),
    ("m.obj", QUAD + "f 1 2 9\n", r"line 5 \(f\): vertex 9, and there are 4"),
    ("m.obj", QUAD + "f -9 2 3\n", r"line 5 \(f\): vertex -9"),
    ("m.obj", QUAD + "f 0 2 3\n", r"line 5 \(f\): vertex 0"),
    ("m.obj", QUAD + f"f 1 2 3\nf 1/{10**20} 2//7 -{10**20} 3\n", rf"line 6 \(f\): vertex -{10**20}, and there are 4,"),
    ("m.obj", QUAD + "v 1 2\n", r"line 5 \(v\): 2 numbers"), ("m.obj", "v 1 2,5 3\n", r"line 1 \(v\): '2,5'"),
    ("m.off", "OFF BINARY\n", "binary OFF"),
    ("m.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n9 0 1 2\n", "face 0: 9 corners"),
    ("m.off", "OFF # four lines\n\n1 0 0\n# a point\n0 y 0\n", "line 5: 'y' is not a number"),
    ("m.off", "1 0 0\n0 y 0\n", "line 2: 'y' is not a number"),
    ("m.off", "OFF\n1 0 0\n0 0\n", "vertex 0: 2 numbers"), ("m.stl", b"\0" * 50, "84 bytes"),
    ("m.stl", ASCII_STL.replace(b"vertex 0 1 0\n", b"") % (b"a", b"a"), "no multiple of three"),
    ("m.stl", ASCII_STL.replace(b"0 1 0", b"0 b 0") % (b"a", b"a"), "solid a, vertex 3: 'b'"),
    ("m.ply", PLY.format("ascii", 4, FACES.format(1)) + CORNERS + "5 0 1 2 3\n", "face 0: its line"),
    ("m.ply", PLY.format("ascii", 4, "") + "0 0 0\n", "vertex: 4 are declared"),
    ("m.ply", PLY.format("ascii", 4, "property half q\n") + CORNERS, "line 7 of the header: 'property half q'")])
def test_errors_say_what_and_where(load, name, content, problem):
    with pytest.raises(InputError, match=problem):
        load(name, content)


def test_damaged_files_are_read_or_named(load):
    """Bytes changed, cut and doubled at random: a scene or an InputError of one line, nothing else."""
    rng = np.random.default_rng(7)
    binary = PLY.format("binary_little_endian", 4, FACES.format(2)).encode() + np.zeros(12, "<f4").tobytes()
    binary += struct.pack("<B4i", 4, 0, 1, 2, 3) + struct.pack("<B3i", 3, 0, 1, 2)
    files = {"m.obj": TEXTURED.encode(), "m.ply": binary, "m.stl": ASCII_STL % (b"a", b"a"),
             "n.ply": (PLY.format("ascii", 4, FACES.format(1)) + CORNERS + "4 0 1 2 3\n").encode(),
             "m.off": ("COFF\n4 1 0\n" + CORNERS.replace("\n", " 1 0 0\n") + "4 0 1 2 3 255 0 0\n").encode(),
             "n.stl": stl(0x8000, 5)}
    for name, data in files.items():
        for _ in range(100):
            bad = bytearray(data)
            for at in rng.integers(0, len(bad), 3):
                bad[at] = rng.choice(list(b"0123456789 -/.#\n\\\0\xffvf"))
            start, end = sorted(rng.integers(0, len(bad), 2))
            if rng.random() < 0.5:
                bad[start:end] = b"" if rng.random() < 0.5 else bad[start:end] * 2
            try:
                load(name, bytes(bad), m_mtl="newmtl m\nKd 1 1 1\n")
            except InputError as error:
                assert "\n" not in str(error)


def test_corners_of_all_kinds_in_one_file(load):
    """Each with its own part of v, v/vt, v//vn and v/vt/vn, and one that ends the file."""
    text = QUAD + "vt 0.25 0.5\nvt 1 1\nvn 0 0 1\nvn 0 1 0\n"
    text += "f 1 2 3\nf 1//2 2//2 3//2\nf 1/1 2/1 3/1\nf 1/2/1 2/2/1 3/2/1"
    plain, normals, uvs, both = load("m.obj", text).meshes
    assert not plain.uvs and plain.normals.tolist() == [[0, 0, 1]] * 3
    assert not normals.uvs and normals.normals.tolist() == [[0, 1, 0]] * 3
    assert uvs.uvs[0].tolist() == [[0.25, 0.5]] * 3 and uvs.normals.tolist() == [[0, 0, 1]] * 3
    assert both.uvs[0].tolist() == [[1, 0]] * 3 and both.normals.tolist() == [[0, 0, 1]] * 3


TRIANGLE_OBJ = "v 0 0 0 nan 0 0\nv 1 0 0 1 0 0\nv 0 1 0 1 0 inf\nf 1 2 3\n"
TRIANGLE_OFF = "COFF\n3 1 0\n0 0 0 nan 0 0 1\n1 0 0 1 0 0 1\n0 1 0 1 0 inf 1\n3 0 1 2\n"
TRIANGLE_PLY = ("ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
                "property float red\nproperty float green\nproperty float blue\nelement face 1\n"
                "property list uchar int vertex_indices\nend_header\n"
                "0 0 0 nan 0 0\n1 0 0 1 0 0\n0 1 0 1 0 inf\n3 0 1 2\n")


@pytest.mark.parametrize("name, text", [("a.obj", TRIANGLE_OBJ), ("a.off", TRIANGLE_OFF), ("a.ply", TRIANGLE_PLY)])
def test_a_colour_that_is_not_finite_is_told(load, name, text):
    scene = load(name, text)
    assert scene.warnings == ("2 colours with a number that is not finite; it counts as full",)
    assert np.isfinite(scene.meshes[0].colors).all()
