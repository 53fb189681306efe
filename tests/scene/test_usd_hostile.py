"""USD files that are broken, or ask for what lies outside of their folder."""

from __future__ import annotations

import os

import pytest
from needs import needs
from usda import APPLIED, BOUND, material, mesh, stage, texture

from viewer.errors import InputError
from viewer.scene.load import load_scene
from viewer.scene.usd.load import apart

pytestmark = needs("usd")
EMPTY = 'def "X" (%s)\n{\n}\n'
VARIANT = """def "X" (
    variants = { string v = "a" }
    prepend variantSets = "v"
)
{
    variantSet "v" = {
        "a" ( references = @%s@ ) {
        }
    }
}
"""


@pytest.fixture
def folder(tmp_path):
    """A folder, with a model in it and one beside it, which no model of the folder may get at."""
    (tmp_path / "model").mkdir()
    secret = '#usda 1.0\n( defaultPrim = "Square" )\n' + mesh()
    (tmp_path / "secret.usda").write_text(secret)
    (tmp_path / "model" / "part.usda").write_text(secret)
    (tmp_path / "model" / "link.usda").symlink_to(tmp_path / "secret.usda")
    return tmp_path / "model"


def read(folder, text, name="a.usda"):
    (folder / name).write_text(text)
    return load_scene(folder / name)


def test_layers_of_the_folder_are_read_and_missing_ones_warned_of(folder):
    scene = read(folder, stage(EMPTY % "references = @./part.usda@" + EMPTY.replace("X", "Y") % "payload = @gone.usda@",
                               head="subLayers = [@part.usda@]"))
    assert scene.triangle_count == 4
    assert scene.warnings == ("the layer 'gone.usda' is not there; it is left out",)


@pytest.mark.parametrize("asked", ["../secret.usda", "link.usda", "{above}/secret.usda"],
                         ids=["above", "a link", "absolute"])
@pytest.mark.parametrize("way", ["sublayer", "reference", "payload", "variant", "nested"])
def test_nothing_outside_of_the_folder_is_read(folder, asked, way):
    asked = asked.format(above=folder.parent)
    body, head = mesh(name="Own"), ""
    if way == "sublayer":
        head = f"subLayers = [@{asked}@]"
    elif way == "variant":
        body += VARIANT % asked
    elif way == "nested":
        (folder / "between.usda").write_text(stage(EMPTY % f"references = @{asked}@", 'defaultPrim = "X"'))
        body += EMPTY % "references = @between.usda@"
    else:
        body += EMPTY % f"{way}{'s' * (way == 'reference')} = @{asked}@"
    with pytest.raises(InputError, match=r"it asks for '.*\.usda', which lies outside the model's folder$"):
        read(folder, stage(body, head))


def test_the_folder_that_one_stands_in_is_not_searched(folder, monkeypatch):
    monkeypatch.chdir(folder.parent)
    apart.close()  # so that another process starts there
    try:
        with pytest.raises(InputError, match="asks for 'secret.usda', which lies outside"):
            read(folder, stage(mesh(name="Own") + EMPTY % "references = @secret.usda@"))
    finally:
        apart.close()


@pytest.mark.parametrize(("prim", "problem"), [
    (EMPTY % 'references = @`"../" + "secret.usda"`@', "by an expression, which is not read"),
    (EMPTY % "clips = { dictionary default = {\nasset[] assetPaths = [@./part.usda@]\n} }\n", "has at /X value clips"),
], ids=["expression", "value clips"])
def test_what_is_found_only_later_is_refused(folder, prim, problem):
    with pytest.raises(InputError, match=problem):
        read(folder, stage(mesh(name="Own") + prim))


@pytest.mark.parametrize("asked", ["../c.png", "link.png", "{above}/c.png"], ids=["above", "a link", "absolute"])
def test_textures_from_outside_are_left_out(folder, asked):
    (folder.parent / "c.png").write_bytes(b"")
    (folder / "link.png").symlink_to(folder.parent / "c.png")
    asked = asked.format(above=folder.parent)
    inputs = "color3f inputs:diffuseColor.connect = </Paint/Color.outputs:rgb>"
    scene = read(folder, stage(material(inputs, texture("Color", asked)) + mesh(BOUND, meta=APPLIED)))
    assert scene.materials[0].base_color_texture is None
    assert scene.warnings == (f"material 'Paint': diffuseColor: {asked!r} lies outside the model's folder; the texture "
                              "is left out",)


@pytest.mark.parametrize(("name", "data", "problem"), [
    ("a.usda", b"", "the file is empty"),
    ("a.usda", b"#usda 1.0\ndef Mesh {", "cannot be read as USD: it is broken in line 2, column "),
    ("a.usd", b"nothing of it", "cannot be read as USD: it is broken"),
    ("a.usdc", b"PXR-USDC" + bytes(80), "cannot be read as USD: it is broken"),
    ("a.usdz", b"PK\3\4" + bytes(80), "cannot be read as USD: it is broken"),
    ("a.usda", stage("").encode(), "the file contains nothing to draw"),
    ("a.usda", stage(mesh(), meters=0).encode(), "cannot be read as USD: it has metersPerUnit = 0"),
    ("a.usda", stage(mesh()).encode().replace(b"Mesh", b"M\xff\xfe"), "cannot be read as USD: it is broken"),
    ("a.usda", stage(mesh(body="int[] faceVertexCounts = [3]\nint[] faceVertexIndices = [0, 1, 9]\n"
                               "point3f[] points = [(0, 0, 0), (1, 0, 0), (1, 1, 0)]")).encode(),
     "cannot be read as USD: it has at /Square a number in faceVertexIndices that is not in 0..2"),
    ("a.usda", stage(mesh(body="int[] faceVertexCounts = [4]\nint[] faceVertexIndices = [0, 1, 2]\n"
                               "point3f[] points = [(0, 0, 0), (1, 0, 0), (1, 1, 0)]")).encode(),
     "cannot be read as USD: it has at /Square faceVertexCounts for 4 corners, and 3 faceVertexIndices"),
])
def test_what_is_broken_is_one_line(tmp_path, name, data, problem):
    (tmp_path / name).write_bytes(data)
    with pytest.raises(InputError) as caught:
        load_scene(tmp_path / name)
    assert str(caught.value).startswith(f"{tmp_path / name}: {problem}") and "\n" not in str(caught.value)
    assert "/opt" not in str(caught.value) and os.sep + "pxr" not in str(caught.value)
