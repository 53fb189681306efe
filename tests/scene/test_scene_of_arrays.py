"""`viewer.scene`: a scene of arrays of any type, or of an object of trimesh, in one call."""

from __future__ import annotations

import math
from types import ModuleType

import numpy as np
import pytest
import trimesh
from PIL import Image as Pillow
from trimesh.visual import TextureVisuals
from trimesh.visual.material import PBRMaterial, SimpleMaterial

import viewer
from viewer.errors import UsageError
from viewer.scene.color import srgb_to_linear
from viewer.scene.mtl import PLAIN

CORNERS = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
FACES = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]


def tetrahedron(**more: object) -> viewer.Scene:
    return viewer.scene(np.float32(CORNERS), FACES, environment=None, **more)


def world(scene: viewer.Scene, mesh: int = 0) -> np.ndarray:
    """The corners of all triangles of a mesh in the world, (M, 3, 3)."""
    made, matrix = scene.meshes[mesh], scene.instances[mesh].transform
    positions = made.positions if made.indices is None else made.positions[made.indices]
    return (positions @ matrix[:3, :3].T + matrix[:3, 3]).reshape(-1, 3, 3)


@pytest.mark.parametrize("dtype", [np.int64, np.int32, np.uint32, np.uint16, np.int8, np.uint8, list])
@pytest.mark.parametrize("kind", [np.float64, np.float16, np.int64, list])
def test_arrays_of_any_type_are_the_same_scene(dtype, kind):
    vertices = CORNERS if kind is list else np.array(CORNERS, kind)
    made = viewer.scene(vertices, FACES if dtype is list else np.array(FACES, dtype), environment=None)
    np.testing.assert_array_equal(world(made), np.array(CORNERS, float)[FACES])
    assert made.materials == (PLAIN,) and made.environment is None and made.name == "scene"
    assert made.meshes[0].normals is not None and len(made.meshes[0].positions) == 12  # all edges are sharp


def test_the_package_keeps_its_modules_and_the_scene_its_place():
    assert isinstance(viewer.scene, ModuleType) and viewer.scene.camera.Camera is viewer.Camera
    far = viewer.scene(np.array(CORNERS) + 1e9, FACES)
    np.testing.assert_array_equal(world(far), np.array(CORNERS, float)[FACES] + 1e9)
    assert far.environment is not None and far.environment.name == "studio"
    up = tetrahedron(up="z")
    np.testing.assert_array_equal(world(up)[3], np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]]))


@pytest.mark.parametrize(("colors", "linear"), [
    (np.uint8([[255, 0, 51]] * 4), [1, 0, srgb_to_linear(np.float64(0.2)), 1]),
    (np.uint16([[65535, 0, 13107, 65535]] * 4), [1, 0, srgb_to_linear(np.float64(0.2)), 1]),
    (np.array([[65535, 0, 13107]] * 4, ">u2"), [1, 0, srgb_to_linear(np.float64(0.2)), 1]),
    ([[1 + 1e-7, -1e-9, 0.0]] * 4, [1, 0, 0, 1]),
    ([[0.5, 0.25, 0.0]] * 4, [0.5, 0.25, 0, 1]),
    (np.array([[0.5, 0.25, 0.0, 0.5]] * 4), [0.5, 0.25, 0, 0.5]),
])
def test_colours_are_srgb_in_bytes_and_linear_in_floats(colors, linear):
    made = tetrahedron(colors=colors)
    np.testing.assert_allclose(made.meshes[0].colors, [linear] * 12, atol=1e-6)
    assert made.materials[0].base_color == (1, 1, 1, 1)
    assert (made.materials[0].alpha_mode == "blend") == (linear[3] < 1)


def test_colours_of_faces_normals_and_uvs():
    flat = viewer.scene(CORNERS, FACES[:2], colors=np.uint8([[255, 0, 0], [0, 255, 0]]))
    np.testing.assert_array_equal(flat.meshes[0].colors[:, :2], [[1, 0]] * 3 + [[0, 1]] * 3)
    made = tetrahedron(normals=np.array([[0, 0, 2], [0, 3, 0], [4, 0, 0], [0, 0, -1]]),
                       uvs=[[0, 0], [1, 0], [0, 1], [1, 1]])
    np.testing.assert_array_equal(made.meshes[0].normals, [[0, 0, 1], [0, 1, 0], [1, 0, 0], [0, 0, -1]])
    np.testing.assert_array_equal(made.meshes[0].uvs[0], [[0, 1], [1, 1], [0, 0], [1, 0]])  # v downwards
    red = viewer.Material(base_color=(1, 0, 0, 1))
    assert tetrahedron(material=red).materials == (red,)
    assert viewer.scene(CORNERS).meshes[0].topology == "points"


@pytest.mark.parametrize(("vertices", "faces", "more", "words"), [
    ([[0, 0]], FACES, {}, r"vertices is \(1, 2\) int64, not \(N, 3\) float64"),
    ("helmet.glb", None, {}, "vertices: str is no array of numbers"),
    ([], FACES, {}, r"vertices is \(0,\)"),
    (np.zeros((0, 3)), FACES, {}, "vertices: there are none"),
    ([[0, 0, math.nan]] * 4, FACES, {}, "vertices .* holds NaN"),
    ([[0, 0, 1e19]] * 4, FACES, {}, "vertices: the model has coordinates beyond"),
    (CORNERS, [[0, 1, 4]], {}, r"faces\[0\] is \[0, 1, 4\], but there are 4 vertices"),
    (CORNERS, [[0, 1, -1]], {}, "faces .* do not fit uint32"),
    (CORNERS, [[0.0, 1.0, 2.0]], {}, "faces is .* float64, not whole numbers"),
    (CORNERS, [[0, 1, 2, 3]], {}, r"faces is \(1, 4\) int64, not \(N, 3\) uint32"),
    (CORNERS, np.zeros((0, 3), int), {}, "faces: there are none; without `faces`"),
    (CORNERS, FACES, {"normals": [[0, 0, 1]]}, r"normals is \(1, 3\)"),
    (CORNERS, FACES, {"uvs": np.zeros((4, 3))}, r"uvs is \(4, 3\)"),
    (CORNERS, FACES, {"colors": [[1, 2, 3]] * 4}, "colors: .* whole numbers above 1 are of uint8 or uint16"),
    (CORNERS, FACES, {"colors": [[-1.0, 0, 0]] * 4}, "colors: a colour is not negative"),
    (CORNERS, FACES, {"colors": [[255.0, 0, 0]] * 4}, "colors: floats are from 0 to 1, and one is 255; make those"),
    (CORNERS, FACES, {"name": 3}, "name is of type int, not text"),
    (CORNERS, FACES, {"colors": "red"}, "colors: str is no array"),
    (CORNERS, FACES, {"material": "gold"}, "material is of type str, not a Material"),
    (CORNERS, FACES, {"up": "up"}, "up='up': it must be one of"),
    (CORNERS, FACES, {"environment": 3}, "environment is of type int"),
    (trimesh.creation.box(), FACES, {}, "faces: a Trimesh of trimesh has its own"),
    (trimesh.Scene(), None, {}, "the Scene of trimesh has nothing to draw"),
])
def test_what_is_no_scene_is_one_line(vertices, faces, more, words):
    with pytest.raises(UsageError, match=words) as caught:
        viewer.scene(vertices, faces, **more)
    assert "\n" not in str(caught.value)


def test_a_mesh_of_trimesh_has_sharp_edges_and_its_colours():
    box = trimesh.creation.box()
    assert box.vertex_normals is not None  # trimesh smooths them over the edges
    made = viewer.scene(box)
    assert made.triangle_count == 12 and np.isin(np.round(made.meshes[0].normals, 6), (-1, 0, 1)).all()
    box.visual.face_colors = [255, 0, 0, 255]
    np.testing.assert_array_equal(viewer.scene(box).meshes[0].colors, [[1, 0, 0, 1]] * 36)
    box.visual.vertex_colors = np.uint8([[0, 255, 0, 255]] * 8)
    np.testing.assert_array_equal(np.unique(viewer.scene(box).meshes[0].colors, axis=0), [[0, 1, 0, 1]])
    cloud = viewer.scene(trimesh.PointCloud([[0, 0, 0], [1, 1, 1]], colors=np.uint8([[0, 0, 255, 255]] * 2)))
    assert cloud.meshes[0].topology == "points" and cloud.meshes[0].colors.tolist() == [[0, 0, 1, 1]] * 2


def test_the_arrays_of_a_mesh_of_trimesh_are_arrays():
    box = trimesh.creation.box()
    made = viewer.scene(box.vertices, box.faces, uvs=box.vertices[:, :2], environment=None)  # of trimesh's own class
    np.testing.assert_array_equal(world(made), box.triangles)


def test_a_scene_of_trimesh_places_and_mirrors_its_meshes():
    box, mirror = trimesh.creation.box(), np.diag([-1.0, 1, 1, 1])
    mirror[:3, 3] = 5, 0, 0
    many = trimesh.Scene()
    many.add_geometry(box, node_name="left")
    many.add_geometry(box, node_name="right", transform=mirror)
    many.add_geometry(trimesh.load_path([[0, 0, 0], [1, 1, 1]]), node_name="line")
    made = viewer.scene(many)
    assert made.warnings == ("line: a Path3D of trimesh is not drawn; it is left out",)
    assert made.bounds.tolist() == [[-0.5, -0.5, -0.5], [5.5, 0.5, 0.5]]
    for mesh, middle in ((0, 0.0), (1, 5.0)):
        a, b, c = np.moveaxis(world(made, mesh), 1, 0)
        outwards = (np.cross(b - a, c - a) * ((a + b + c) / 3 - (middle, 0, 0))).sum(axis=1)
        assert (outwards > 0).all()


def test_materials_of_trimesh_have_their_image_and_factors():
    image = Pillow.new("RGB", (2, 2), (255, 0, 0))
    uv = np.array([[0.0, 0], [1, 0], [0, 1], [1, 1]])
    metal = PBRMaterial(name="m", baseColorTexture=image, baseColorFactor=[255, 255, 51, 255], metallicFactor=0.25,
                        roughnessFactor=0.75, normalTexture=image)
    made = viewer.scene(trimesh.Trimesh(CORNERS, FACES, visual=TextureVisuals(uv=uv, material=metal), process=False))
    (material,) = made.materials
    assert material.base_color == pytest.approx((1, 1, 0.2, 1)) and material.name == "m"
    assert (material.metallic, material.perceptual_roughness) == (0.25, 0.75)
    assert material.base_color_texture.image.decode("RGB").tolist() == [[[255, 0, 0]] * 2] * 2
    (line,) = made.warnings
    assert line == "mesh: its material is without normalTexture; viewer.load reads files with them"
    cut = PBRMaterial(baseColorTexture=Pillow.new("CMYK", (2, 2)), alphaMode="MASK", alphaCutoff=0.25,
                      emissiveFactor=[0.5, 0, 0])
    made = viewer.scene(trimesh.Trimesh(CORNERS, FACES, visual=TextureVisuals(uv=uv, material=cut), process=False))
    (material,) = made.materials
    assert (material.alpha_mode, material.alpha_cutoff, material.emissive) == ("mask", 0.25, (0.5, 0, 0))
    assert material.base_color_texture.image.decode("RGB").tolist() == [[[255] * 3] * 2] * 2 and not made.warnings
    lost = viewer.scene(trimesh.Trimesh(CORNERS, FACES, visual=TextureVisuals(material=metal), process=False))
    assert "mesh: it has no texture coordinates for its image, which is left out" in lost.warnings
    painted = TextureVisuals(uv=uv, material=SimpleMaterial(image=image, diffuse=[51, 0, 0, 255]))
    (material,) = viewer.scene(trimesh.Trimesh(CORNERS, FACES, visual=painted, process=False)).materials
    assert material.base_color == (1, 1, 1, 1) and material.base_color_texture is not None
    plain = TextureVisuals(material=SimpleMaterial(diffuse=[51, 0, 0, 255]))
    (material,) = viewer.scene(trimesh.Trimesh(CORNERS, FACES, visual=plain, process=False)).materials
    assert material.base_color == pytest.approx((float(srgb_to_linear(np.float64(0.2))), 0, 0, 1), abs=1e-6)


def test_what_is_wrong_with_objects_of_trimesh_is_told_with_its_place():
    for factor in (5, math.nan):
        visual = TextureVisuals(material=PBRMaterial(roughnessFactor=factor))
        with pytest.raises(UsageError, match="^mesh: its roughnessFactor"):
            viewer.scene(trimesh.Trimesh(CORNERS, FACES, visual=visual, process=False))
    many = trimesh.Scene()
    many.add_geometry(trimesh.creation.box(), node_name="lost", transform=np.full((4, 4), np.nan))
    with pytest.raises(UsageError, match="^lost: its matrix .* holds NaN"):
        viewer.scene(many)


@pytest.mark.parametrize("length", [1e300, 1e-300])
@pytest.mark.filterwarnings("error")
def test_normals_may_have_any_length(length):
    made = tetrahedron(normals=np.array([[0, 0, 1], [0, 3, 0], [0, 0, 1], [0, 0, -1]]) * length)
    np.testing.assert_array_equal(made.meshes[0].normals, [[0, 0, 1], [0, 1, 0], [0, 0, 1], [0, 0, -1]])
