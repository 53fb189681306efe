"""What Python may give to a material, a light, a camera, a mesh or a scene: what the specifications forbid is refused
in one line that names the class, the field and the range, and what they allow is taken."""

from __future__ import annotations

import math
import warnings
from dataclasses import replace
from re import escape

import numpy as np
import pytest
from gltf_builder import GltfBuilder

import viewer
from viewer.scene.schema import PARAMETERS, Parameter

POSITIONS = np.float32([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]])
IDENTITY = np.eye(4)
RANGED = [p for p in PARAMETERS.values() if math.isfinite(p.info.low) or math.isfinite(p.info.held)]


def filled(parameter: Parameter, number: float) -> object:
    return number if parameter.size == 1 else (number,) * parameter.size


def square(**changes) -> viewer.Mesh:
    return viewer.Mesh(**{"name": "square", "positions": POSITIONS, "material": 0,
                          "indices": [0, 1, 2, 0, 2, 3]} | changes)


@pytest.mark.parametrize("parameter", RANGED, ids=lambda p: p.name)
def test_a_parameter_of_a_material_keeps_to_its_declared_range(parameter):
    info = parameter.info
    for end in (info.low, info.held):
        if math.isfinite(end):
            value = filled(parameter, end)
            assert getattr(viewer.Material(**{parameter.name: value}), parameter.name) == value
    for number in (info.low - 0.25, 2 * info.held + 0.25):
        if math.isfinite(number):
            low = escape(f"{info.low:g}")
            with pytest.raises(viewer.UsageError, match=rf"^Material\.{parameter.name} is .*, not .*{low}"):
                viewer.Material(**{parameter.name: filled(parameter, number)})


@pytest.mark.parametrize("changes", [
    {"ior": 0}, {"ior": 1}, {"perceptual_roughness": 0}, {"emissive": (1e5, 0, 0)}, {"specular_color": (25, 25, 25)},
    {"attenuation_distance": math.inf}, {"alpha_cutoff": 2}, {"normal_scale": -1}, {"anisotropy_rotation": 100.0},
    {"metallic": np.float32(0.5)}, {"double_sided": np.True_}, {"double_sided": 1}, {"shininess": 0}], ids=str)
def test_what_a_material_may_be(changes):
    (name, value), = changes.items()
    assert getattr(viewer.Material(**changes), name) == value


@pytest.mark.parametrize("number", [-7.0, 1e30])
def test_a_file_is_clamped_to_what_a_material_may_be(number):
    """With each parameter of the specification far out of its range, the file loads, and warns of most."""
    builder = GltfBuilder(materials=[{"extensions": {}}])
    for parameter in RANGED:
        feature, key = parameter.info.feature, parameter.info.key
        if "." in key:
            continue  # of a texture
        place = builder.json["materials"][0]
        if feature.extension:
            place = place["extensions"].setdefault(feature.extension, {})
        place = place.setdefault(feature.place, {}) if feature.place else place
        place[key] = number if parameter.size == 1 else [number] * parameter.size
    builder.node(mesh=builder.triangle(material=0))
    assert sum("is out of range" in line for line in builder.load().warnings) > 20


@pytest.mark.parametrize("make, words", [
    (lambda: viewer.Material(thickness=10**400), r"Material\.thickness is beyond 1\.8e308"),
    (lambda: viewer.Material(ior=0.5), r"Material\.ior is 0\.5, not 0 or from 1 to 1e\+09"),
    (lambda: viewer.Material(ior=math.inf), r"Material\.ior is inf, not a finite number"),
    (lambda: viewer.Material(normal_scale=math.inf), r"Material\.normal_scale is inf, not a finite number"),
    (lambda: viewer.Material(double_sided="yes"), r"Material\.double_sided is 'yes', not True or False"),
    (lambda: viewer.Material(unlit=None), r"Material\.unlit is None, not True or False"),
    (lambda: viewer.Material(name=3), r"Material\.name is of type int, not text"),
    (lambda: viewer.Material(shininess=-1), r"Material\.shininess is -1, not at least 0"),
    (lambda: viewer.Material(weave="twill"), r"Material\.weave is of type str, not a Weave"),
    (lambda: replace(viewer.Material(), metallic=2), r"Material\.metallic is 2, not from 0 to 1"),
    (lambda: viewer.Light("point", intensity=-1), r"Light\.intensity is -1, not at least 0"),
    (lambda: viewer.Light("point", color=(1, -1, 1)), r"Light\.color is .*, not at least 0"),
    (lambda: viewer.Light("point", range=0), r"Light\.range is 0, not above 0"),
    (lambda: viewer.Light("point", radius=-1), r"Light\.radius is -1, not at least 0"),
    (lambda: viewer.Light("spot", outer_cone=45), r"Light\.outer_cone is 45, not from 0 to 1\.5708"),
    (lambda: viewer.Light("spot", inner_cone=1.2), r"Light\.inner_cone is 1\.2, wider than its outer_cone, 0\.78"),
    (lambda: viewer.Light("point", casts_shadow="no"), r"Light\.casts_shadow is 'no', not True or False"),
    (lambda: viewer.Light.from_angles("left", 0, 1), r"azimuth is of type str, not a number"),
    (lambda: viewer.Light.from_angles(0, math.inf, 1), r"elevation is inf, not a finite number"),
    (lambda: viewer.Camera.look_at((1, 2, 3), (1, 2, 3)), r"eye and target are both 1, 2, 3"),
    (lambda: viewer.Camera.orbit((0, 0, 0), 0), r"distance is 0"),
    (lambda: viewer.Camera.framing((0, 0, 0), "large", 1), r"radius is of type str, not a number"),
    (lambda: viewer.Camera(IDENTITY).intrinsics(640), r"size is \(\) int64"),
    (lambda: viewer.Camera(IDENTITY).projection(1, 10, 1), r"near=10, far=1: near must be below far"),
    (lambda: viewer.Scene("s").framing_camera(1, fov_y=45), r"fov_y is 45, .*in radians"),
    (lambda: viewer.Scene("s").framing_camera(1, target="left"), r"target: str is no array of numbers"),
    (lambda: square(indices=[]), r"Mesh\.indices has 0: a mesh without triangles cannot be drawn"),
    (lambda: square(indices=[0, 1]), r"Mesh\.indices has 2: a mesh without triangles cannot be drawn"),
    (lambda: square(positions=np.zeros((0, 3)), indices=None), r"Mesh\.positions has 0"),
    (lambda: square(colors=np.full((4, 4), 200)), r"Mesh\.colors are from 200 to 200, not from 0 to 1"),
    (lambda: square(colors=np.full((4, 3), -0.5)), r"Mesh\.colors are from -0\.5 to 1, not from 0 to 1"),
    (lambda: square(uvs=None), r"Mesh\.uvs is of type NoneType, not a tuple of arrays"),
    (lambda: square(material="red"), r"Mesh\.material is of type str, not the number of a material"),
    (lambda: square(material=-1), r"Mesh\.material is -1, not the number of a material"),
    (lambda: viewer.Instance("square", IDENTITY), r"Instance\.mesh is of type str, not the number of a mesh"),
    (lambda: viewer.Instance(0.0, IDENTITY), r"Instance\.mesh is of type float, not the number of a mesh"),
    (lambda: viewer.Instance(0, np.diag([1, 1, 1, 2])), r"Instance\.transform\[3\] is .*, not 0, 0, 0, 1"),
    (lambda: viewer.Scene("s").with_curve_radius(-1), r"radius is -1, not at least 0"),
    (lambda: viewer.Volume.in_box([[[1, 2], [3]]], [[0] * 3, [1] * 3]), r"density: list is no array of numbers"),
    (lambda: viewer.CameraFrame("front", (4, 3)), r"CameraFrame\.camera is of type str, not a Camera"),
    (lambda: viewer.CameraFrame(viewer.Camera(IDENTITY), (0, 3)), r"CameraFrame\.size=\(0, 3\): it must be"),
    (lambda: viewer.CameraFrame(viewer.Camera(IDENTITY), (4, 3), 7), r"CameraFrame\.file is of type int, not a path"),
    (lambda: viewer.read_cameras("cameras.json", 640), r"size=640: it must be \(width, height\)"),
    (lambda: viewer.render(viewer.Scene("s"), (8, 8), backend=["egl"]), r"backend is of type list, not auto, egl"),
    (lambda: viewer.call_glsl("bsdf/ggx.glsl", "f", defines={"A": "1"}), r"defines\['A'\] is of type str, not a num"),
    (lambda: viewer.call_glsl("bsdf/ggx.glsl", "f", context="egl"), r"context is of type str, not a Context"),
    (lambda: viewer.Scene(3), r"Scene\.name is of type int, not text"),
    (lambda: viewer.Scene("s", animations=("walk",)), r"Scene\.animations\[0\] is of type str, not an Animation"),
])
def test_what_is_out_of_range_is_one_line(make, words):
    with warnings.catch_warnings(), pytest.raises(viewer.UsageError, match=words) as caught:
        warnings.simplefilter("error")
        make()
    assert "\n" not in str(caught.value)


def test_the_files_of_a_camera_may_be_text(tmp_path):
    frame = viewer.CameraFrame(viewer.Camera(IDENTITY), np.array([4, 3]), str(tmp_path / "a.png"))
    viewer.write_cameras(tmp_path / "cameras.json", [frame])
    found, = viewer.read_cameras(tmp_path / "cameras.json")
    assert found.file == frame.file == tmp_path / "a.png" and found.size == frame.size == (4, 3)


def test_what_a_light_may_be():
    for outer in (math.pi / 2, np.float32(math.pi / 2), 1.5708):
        assert viewer.Light("spot", outer_cone=outer).outer_cone == outer
    assert viewer.Light("spot", inner_cone=0.5, outer_cone=0.5).inner_cone == 0.5
    assert viewer.Light("point", inner_cone=1).inner_cone == 1  # which counts for spot lights only
    assert viewer.Light("point", range=math.inf, intensity=1e40).range == math.inf


def test_cameras_look_from_and_to_anywhere():
    far = viewer.Camera.look_at((1e300, 0, 0), (-1e300, 0, 0), (0, 1e300, 0))
    np.testing.assert_array_equal(far.forward, (-1, 0, 0))
    np.testing.assert_array_equal(viewer.Camera.look_at((0, 5, 0), (0, 0, 0)).forward, (0, -1, 0))
    np.testing.assert_array_equal(viewer.Camera.look_at((0, 0, 1e-300), (0, 0, 0)).forward, (0, 0, -1))


def test_a_far_camera_of_a_file_keeps_its_direction():
    """Its position takes all digits, so that a point one unit in front of it is the same point."""
    turn = [0, math.sin(0.5), 0, math.cos(0.5)]
    builder = GltfBuilder(cameras=[{"type": "perspective", "perspective": {"yfov": 0.8, "znear": 0.1}}])
    builder.node(camera=0, translation=[1e17, 0, 1e17], rotation=turn)
    camera, = builder.load().cameras
    np.testing.assert_allclose(camera.forward, (-math.sin(1), 0, -math.cos(1)), atol=1e-6)
