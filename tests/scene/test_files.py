import os

import pytest

from viewer.errors import InputError
from viewer.scene.files import path_inside, read_file


@pytest.fixture
def model(tmp_path):
    folder = tmp_path / "folder"
    (folder / "sub").mkdir(parents=True)
    (tmp_path / "secret.txt").write_bytes(b"secret")
    (folder / "a b.bin").write_bytes(b"1")
    (folder / "sub" / "c.bin").write_bytes(b"2")
    (folder / "100%.bin").write_bytes(b"3")
    (folder / "model.gltf").write_bytes(b"{}")
    return folder / "model.gltf"


@pytest.mark.parametrize("uri, content", [
    ("a%20b.bin", b"1"), ("a b.bin", b"1"), ("sub/c.bin", b"2"), ("./sub/../a%20b.bin", b"1"), ("100%.bin", b"3")])
def test_files_inside(model, uri, content):
    assert read_file(path_inside(model, uri, "x")) == content


@pytest.mark.parametrize("uri", [
    "../secret.txt", "%2e%2e/secret.txt", "sub/../../secret.txt", "..%2Fsecret.txt", "/etc/hostname",
    "%2Fetc%2Fhostname", "file:///etc/hostname", "http://localhost/x", "//host/x", "C:\\x", "C:/x", "..\\secret.txt",
    "\\\\host\\x", "", "a\0b", "model.gltf", "missing.bin", "x" * 5000])
def test_everything_else_is_refused(model, uri):
    with pytest.raises(InputError, match="^.*model.gltf: uri: "):
        path_inside(model, uri, "uri")


def test_links_may_not_leave_the_folder(model):
    os.symlink(model.parent.parent / "secret.txt", model.parent / "link.bin")
    os.symlink(model.parent / "a b.bin", model.parent / "inner.bin")
    with pytest.raises(InputError, match="outside"):
        path_inside(model, "link.bin", "uri")
    assert read_file(path_inside(model, "inner.bin", "uri")) == b"1"


def test_folders_pipes_and_missing_files(model, tmp_path):
    os.mkfifo(tmp_path / "pipe")
    for path, problem in [(model.parent, "folder"), (tmp_path / "pipe", "regular"), (tmp_path / "none", "no such")]:
        with pytest.raises(InputError, match=problem):
            read_file(path)
