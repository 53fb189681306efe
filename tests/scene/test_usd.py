"""USD: meshes, where they stand, and their materials; read where the package of an extra is installed."""

from __future__ import annotations

import zipfile

import numpy as np
import pytest
from gltf_builder import png_bytes
from needs import needs
from usda import APPLIED, BOUND, material, mesh, stage, texture

from viewer.errors import InputError
from viewer.scene import load
from viewer.scene.load import load_scene


def read(tmp_path, text, name="a.usda"):
    (tmp_path / name).write_text(text)
    return load_scene(tmp_path / name)


def facing(scene):
    """The direction that the first triangle faces by its winding, and the mean of the normals."""
    made = scene.meshes[0]
    a, b, c = made.positions[:3] if made.indices is None else made.positions[made.indices[:3]]
    normal = np.cross(b - a, c - a)
    return normal / np.linalg.norm(normal), made.normals.mean(axis=0)


@needs("usd")
@pytest.mark.parametrize(("meters", "up", "bounds", "front"), [
    (1, "Y", [[5, 0, 0], [7, 2, 0]], (0, 0, 1)),
    (0.01, "Y", [[0.05, 0, 0], [0.07, 0.02, 0]], (0, 0, 1)),
    (1, "Z", [[5, 0, -2], [7, 0, 0]], (0, 1, 0)),
])
def test_a_square_in_metres_with_y_up(tmp_path, meters, up, bounds, front):
    placed = f"""def Xform "Parent"
{{
    double3 xformOp:translate = (5, 0, 0)
    uniform token[] xformOpOrder = ["xformOp:translate"]
    {mesh('float3 xformOp:scale = (2, 2, 2)' + chr(10) + 'uniform token[] xformOpOrder = ["xformOp:scale"]')}
}}"""
    scene = read(tmp_path, stage(placed, meters=meters, up=up))
    assert scene.triangle_count == 2 and scene.facts["format"] == "USD" and not scene.warnings
    np.testing.assert_allclose(scene.bounds, bounds, atol=1e-6)
    for direction in facing(scene):
        np.testing.assert_allclose(direction, front, atol=1e-6)


@needs("usd")
@pytest.mark.parametrize(("more", "front"), [
    ('uniform token orientation = "leftHanded"', -1),
    ('float3 xformOp:scale = (-1, 1, 1)\nuniform token[] xformOpOrder = ["xformOp:scale"]', 1),
    ('float3 xformOp:scale = (-1, 1, 1)\nuniform token[] xformOpOrder = ["xformOp:scale"]\n'
     'uniform token orientation = "leftHanded"', -1),
], ids=["left-handed", "mirrored", "both"])
def test_what_a_face_looks_at(tmp_path, more, front):
    scene = read(tmp_path, stage(mesh(more)))
    for direction in facing(scene):
        np.testing.assert_allclose(direction, (0, 0, front), atol=1e-6)


@needs("usd")
def test_the_values_of_a_surface(tmp_path):
    inputs = """color3f inputs:diffuseColor = (0.1, 0.2, 0.3)
        color3f inputs:emissiveColor = (4, 5, 6)
        float inputs:metallic = 0.25
        float inputs:roughness = 0.75
        float inputs:clearcoat = 0.5
        float inputs:clearcoatRoughness = 0.125
        float inputs:opacity = 0.5
        float inputs:ior = 1.25"""
    scene = read(tmp_path, stage(material(inputs) + mesh(BOUND + "\nuniform bool doubleSided = 1", meta=APPLIED)))
    (paint,) = scene.materials
    assert paint.name == "Paint" and paint.double_sided and paint.alpha_mode == "blend"
    np.testing.assert_allclose([*paint.base_color, *paint.emissive], [0.1, 0.2, 0.3, 0.5, 4, 5, 6], rtol=1e-6)
    assert (paint.metallic, paint.perceptual_roughness, paint.clearcoat, paint.clearcoat_roughness, paint.ior) \
        == (0.25, 0.75, 0.5, 0.125, 1.25)
    specular = "int inputs:useSpecularWorkflow = 1\ncolor3f inputs:specularColor = (0.08, 0.04, 0)"
    (shiny,) = read(tmp_path, stage(material(specular) + mesh(BOUND, meta=APPLIED))).materials
    np.testing.assert_allclose(shiny.specular_color, (2, 1, 0), rtol=1e-6)
    assert shiny.metallic == 0 and shiny.ior == 1.5


@needs("usd")
def test_textures_in_the_channels_that_they_have_here(tmp_path):
    for name, pixel in (("color", (200, 100, 50)), ("rough", (30, 40, 50)), ("metal", (60, 70, 80))):
        (tmp_path / f"{name}.png").write_bytes(png_bytes(np.full((2, 2, 3), pixel, np.uint8)))
    inputs = """color3f inputs:diffuseColor.connect = </Paint/Color.outputs:rgb>
        float inputs:roughness.connect = </Paint/Rough.outputs:r>
        float inputs:metallic.connect = </Paint/Metal.outputs:g>
        float inputs:opacity.connect = </Paint/Metal.outputs:r>
        float inputs:opacityThreshold = 0.2"""
    shaders = texture("Color", "./color.png", "float4 inputs:scale = (0.5, 0.5, 1, 1)") \
        + texture("Rough", "rough.png") + texture("Metal", "./metal.png")
    scene = read(tmp_path, stage(material(inputs, shaders) + mesh(BOUND, meta=APPLIED)))
    (paint,) = scene.materials
    assert not scene.warnings and paint.alpha_mode == "mask" and paint.alpha_cutoff == pytest.approx(0.2)
    assert paint.base_color[:3] == (0.5, 0.5, 1) and paint.metallic == paint.perceptual_roughness == 1
    assert paint.base_color_texture.sampler.wrap_s == "repeat" and paint.base_color_texture.sampler.wrap_t == "clamp"
    assert paint.base_color_texture.image.decode()[0, 0].tolist() == [200, 100, 50, 60]
    assert paint.metallic_roughness_texture.image.decode()[0, 0, 1:].tolist() == [30, 70]
    np.testing.assert_allclose(sorted(scene.meshes[0].uvs[0].tolist()), [[0, 0], [0, 1], [1, 0], [1, 1]])


@needs("usd")
def test_coordinates_by_corner_turned_and_moved(tmp_path):
    (tmp_path / "c.png").write_bytes(png_bytes(np.zeros((2, 2, 3), np.uint8)))
    turn = """def Shader "Turn"
    {
        uniform token info:id = "UsdTransform2d"
        float2 inputs:in.connect = </Paint/Reader.outputs:result>
        float inputs:rotation = 90
        float2 inputs:scale = (2, 1)
        float2 inputs:translation = (0.5, 0)
        float2 outputs:result
    }
    """
    own = """rel material:binding = </Paint>
        texCoord2f[] primvars:map1 = [(0, 0), (1, 0), (1, 0.25)] (interpolation = "faceVarying")
        int[] primvars:map1:indices = [0, 1, 2, 0]"""
    scene = read(tmp_path, stage(
        material("color3f inputs:diffuseColor.connect = </Paint/Color.outputs:rgb>",
                 turn + texture("Color", "c.png", reader="Turn")) + mesh(own, meta=APPLIED)))
    (made,) = scene.meshes
    at = {tuple(position[:2].tolist()): uv.tolist() for position, uv in zip(made.positions, made.uvs[0])}
    # Scaled, turned counter-clockwise, moved: (u, v) to (0.5 - v, 2 u); v is downwards in a Mesh.
    for corner, uv in {(0, 0): (0.5, 1), (1, 0): (0.5, -1), (1, 1): (0.25, -1), (0, 1): (0.5, 1)}.items():
        np.testing.assert_allclose(at[corner], uv, atol=1e-6)


@needs("usd")
def test_subsets_have_materials_of_their_own(tmp_path):
    body = """int[] faceVertexCounts = [3, 3]
        int[] faceVertexIndices = [0, 1, 2, 0, 2, 3]
        point3f[] points = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]
        uniform token subdivisionScheme = "none"
"""
    subset = f"""rel material:binding = </Paint>
    def GeomSubset "Half" ({APPLIED})
    {{
        uniform token elementType = "face"
        uniform token familyName = "materialBind"
        int[] indices = [1]
        rel material:binding = </Other>
    }}"""
    scene = read(tmp_path, stage(material("") + material("float inputs:roughness = 0.1", name="Other")
                                 + mesh(subset, body=body, meta=APPLIED)))
    found = {scene.materials[made.material].name: made.positions for made in scene.meshes}
    assert found["Other"][:, 0].tolist().count(0) == 2 and found["Paint"][:, 0].tolist().count(1) == 2


@needs("usd")
def test_what_is_not_drawn_is_said(tmp_path):
    hidden = [mesh('token visibility = "invisible"', name="Invisible"),
              mesh('uniform token purpose = "guide"', name="Guide"),
              'def PointInstancer "Many" {\n' + mesh(name="Prototype") + "}\n", 'def Sphere "Ball" {\n}\n',
              mesh(name="Cage").replace('subdivisionScheme = "none"', 'subdivisionScheme = "catmullClark"'),
              mesh("float3 xformOp:scale.timeSamples = { 1: (1, 1, 1), 2: (2, 2, 2), }\n"
                   'uniform token[] xformOpOrder = ["xformOp:scale"]', name="Moving")]
    scene = read(tmp_path, stage("".join(hidden)))
    assert [made.name for made in scene.meshes] == ["Cage", "Moving"]
    assert set(scene.warnings) == {
        "1 PointInstancer: not read; left out", "1 Sphere: not read; left out",
        "1 subdivision surfaces: their cages are drawn", "the file is animated; its first moment is shown"}


@needs("usd")
def test_cameras_and_skeletons_that_are_left_out_are_said(tmp_path):
    kinds = ("Camera", "Skeleton", "SkelAnimation", "BlendShape", "SkelRoot")
    lost = "".join(f'def {kind} "{kind}" {{}}\n' for kind in kinds)
    assert sorted(read(tmp_path, stage(mesh() + lost)).warnings) == sorted(
        f"1 {kind}: not read; left out" for kind in kinds[:-1])


@needs("usd")
def test_a_package_with_its_textures(tmp_path):
    inputs = "color3f inputs:diffuseColor.connect = </Paint/Color.outputs:rgb>"
    with zipfile.ZipFile(tmp_path / "a.usdz", "w") as package:  # stored, as they have to be
        package.writestr("a.usda", stage(material(inputs, texture("Color", "t/c.png")) + mesh(BOUND, meta=APPLIED)))
        package.writestr("t/c.png", png_bytes(np.full((2, 2, 3), 7, np.uint8)))
    scene = load_scene(tmp_path / "a.usdz")
    assert scene.materials[0].base_color_texture.image.decode()[0, 0].tolist() == [7, 7, 7] and not scene.warnings


@needs("usd")
def test_a_file_that_has_changed_is_read_anew(tmp_path):
    assert read(tmp_path, stage(mesh())).triangle_count == 2
    assert read(tmp_path, stage(mesh() + mesh(name="Second"))).triangle_count == 4


def test_without_the_package_the_error_says_what_to_install(tmp_path, monkeypatch):
    monkeypatch.setattr(load, "find_spec", lambda name: None)
    with pytest.raises(InputError, match=r"USDA needs packages .* pip install 'pbr-viewer\[usd\]'"):
        read(tmp_path, stage(""))


@needs("usd")
def test_values_of_another_kind_are_not_taken(tmp_path):
    inputs = """token inputs:roughness = "a"
        float inputs:metallic = nan
        float inputs:diffuseColor = 3
        float3 inputs:clearcoat = (1, 1, 1)"""
    (paint,) = read(tmp_path, stage(material(inputs) + mesh(BOUND, meta=APPLIED))).materials
    assert paint.base_color == (0.18, 0.18, 0.18, 1) and (paint.metallic, paint.clearcoat) == (0, 0)
    assert paint.perceptual_roughness == 0.5
    lost = mesh('double3 xformOp:translate = (nan, 0, 0)\nuniform token[] xformOpOrder = ["xformOp:translate"]', "Lost")
    assert read(tmp_path, stage(mesh() + lost)).warnings == ("Lost: its transform is not of finite numbers; left out",)
