import pytest
from gltf_builder import GltfBuilder, triangle_glb

from viewer.errors import InputError
from viewer.scene.load import load_scene

PLY = b"ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n" \
      b"element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"


@pytest.mark.parametrize("name, data, kind", [
    ("a.glb", triangle_glb(), "GLB 2.0"), ("a.stl", triangle_glb(), "GLB 2.0"), ("a.dat", PLY, "PLY"),
    ("a.txt", b' {"asset": {"version": "2.0"}}', "glTF 2.0")])
def test_content_decides(tmp_path, name, data, kind):
    (tmp_path / name).write_bytes(data)
    assert load_scene(tmp_path / name).facts["format"] == kind


@pytest.mark.parametrize("name, data, problem", [
    ("a.glb", b"", "empty"), ("a.xyzzy", b"hello", "not a model"), ("a.gltf", b"hello", "JSON"),
    ("a", b"hello", "not a model"), ("a.hdr", b"#?RADIANCE", "a picture, not a model; .*--env")])
def test_unknown_files(tmp_path, name, data, problem):
    (tmp_path / name).write_bytes(data)
    with pytest.raises(InputError, match=problem):
        load_scene(tmp_path / name)


def test_missing_files_and_folders(tmp_path):
    for path, problem in [(tmp_path / "none.glb", "no such file"), (tmp_path, "folder"), ("a\0b", "cannot be read")]:
        with pytest.raises(InputError, match=problem):
            load_scene(path)


def test_absurd_extent(tmp_path):
    builder = GltfBuilder()
    builder.node(mesh=builder.triangle(), scale=[1e30, 1, 1])
    (tmp_path / "a.glb").write_bytes(builder.glb())
    with pytest.raises(InputError, match="beyond"):
        load_scene(tmp_path / "a.glb")
