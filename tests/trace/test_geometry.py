"""viewer/trace/scene/geometry.py: the triangles of a scene, their places and materials."""

from __future__ import annotations

import io
from dataclasses import replace

import numpy as np
import pytest
from images import image_of, noise
from PIL import Image
from shapes import moved, plate, scene, sphere

from viewer.plan.warnings import sample_warnings
from viewer.scene.material import Material, Texture
from viewer.scene.mesh import Mesh
from viewer.scene.scene import Instance, Scene
from viewer.scene.texture_image import open_texture_image
from viewer.settings import Settings
from viewer.trace.kinds import GLASS, SURFACE
from viewer.trace.scene.encode import unused_maps
from viewer.trace.scene.geometry import trace_geometry
from viewer.trace.scene.traced_scene import plan_without_device


def placed(geometry, instance) -> np.ndarray:
    """An instance's triangles in tracer space, (T, 3, 3) float64."""
    mesh = geometry.meshes[instance.mesh]
    points = mesh.positions.astype(np.float64) @ instance.transform[:, :3].T + instance.transform[:, 3]
    return points[mesh.triangles]


def test_a_mesh_is_kept_once_and_fills_its_box():
    ball = replace(sphere(segments=8), positions=sphere(segments=8).positions * np.float32([2, 8, 4]) + np.float32(50))
    one = Scene("s", (ball,), (Material(),), tuple(Instance(0, moved((k, 0, 0), k)) for k in (1, 2, 3)))
    geometry = trace_geometry(one)
    (mesh,) = geometry.meshes
    assert len(geometry.instances) == 3 and {i.mesh for i in geometry.instances} == {0}
    assert mesh.positions.dtype == np.float32 and mesh.triangles.dtype == np.uint32
    np.testing.assert_allclose(mesh.positions.min(axis=0), [-0.25, -1, -0.5], atol=1e-6)
    np.testing.assert_allclose(mesh.positions.max(axis=0), [0.25, 1, 0.5], atol=1e-6)
    assert geometry.triangle_count == one.triangle_count


@pytest.mark.parametrize("scale, offset", [(1, 0), (1e-6, 0), (1e6, 0), (1, 1e6), (1e-3, 1e3)])
def test_all_lies_in_the_unit_ball_where_the_scene_has_it(scale, offset):
    shape = scene((sphere(segments=12), moved((offset + scale, offset, offset), (scale, 2 * scale, -scale))),
                  (plate(), moved((offset - 3 * scale, offset, offset), scale)))
    geometry = trace_geometry(shape)
    farthest = 0.0
    for instance in geometry.instances:
        source = shape.instances[instance.source]
        mesh = shape.meshes[source.mesh]
        world = mesh.positions.astype(np.float64) @ source.transform[:3, :3].T + source.transform[:3, 3]
        expected = ((world - shape.center) / shape.radius)[mesh.indices.reshape(-1, 3)]
        # Positions are rounded to float32 relative to their mesh's size; transforms are float64.
        assert np.abs(placed(geometry, instance) - expected).max() < 2.0**-24 + 4 * offset / scale * 2.0**-52
        farthest = max(farthest, np.linalg.norm(placed(geometry, instance), axis=-1).max())
        assert instance.is_mirrored == (instance.source == 0)
    assert farthest == pytest.approx(1, abs=1e-6)


def test_vertices_that_no_triangle_has_change_nothing():
    mesh = plate()
    stray = replace(mesh, positions=np.concatenate([mesh.positions, np.float32([[1e9, 0, 0]])]),
                    normals=None, tangents=None, uvs=())
    np.testing.assert_array_equal(trace_geometry(scene(stray)).meshes[0].positions[:4],
                                  trace_geometry(scene(mesh)).meshes[0].positions)


def test_lines_points_and_nothing_are_left_out():
    line = Mesh("line", np.float32([[0, 0, 0], [1, 0, 0]]), 0, topology="lines")
    points = Mesh("points", np.float32([[0, 0, 0]]), 0, topology="points")
    geometry = trace_geometry(scene(line, plate(), points))
    assert [i.source for i in geometry.instances] == [1] and geometry.left_out_instances == 2
    nothing = trace_geometry(Scene("none"))
    assert not nothing.instances and not nothing.meshes and nothing.triangle_count == 0


def test_lines_and_points_that_are_not_shown_are_warned_of():
    line = Mesh("line", np.float32([[0, 0, 0], [1, 0, 0]]), 0, topology="lines")

    def lines(*meshes: Mesh) -> list[str]:
        plan = plan_without_device(scene(*meshes), Settings.of(mode="path"))
        return sample_warnings({"samples": 1, "plan": plan.to_json()})

    assert lines(line, plate()) == ["1 mesh of lines or points: mode path does not show them"]
    assert lines(line, line) == ["2 meshes of lines or points: mode path does not show them"] and not lines(plate())


def test_meshes_without_indices_and_with_odd_ends():
    loose = Mesh("loose", np.random.default_rng(0).uniform(size=(8, 3)).astype(np.float32), 0)
    np.testing.assert_array_equal(trace_geometry(scene(loose)).meshes[0].triangles, [[0, 1, 2], [3, 4, 5]])


def test_kinds():
    glass = Material(metallic=0.0, transmission=0.5)
    kinds = [SURFACE, GLASS, SURFACE, GLASS, SURFACE]
    materials = (Material(), glass, replace(glass, metallic=1.0),
                 replace(glass, metallic=1.0, metallic_roughness_texture=Texture(image_of(noise(2, 2)))),
                 replace(glass, unlit=True))
    one = scene(*(plate(k) for k in range(5)), materials=materials)
    assert [i.kind for i in trace_geometry(one).instances] == kinds


@pytest.mark.parametrize("material, is_see_through", [
    (Material(base_color=(1, 1, 1, 0.5)), False),
    (Material(base_color=(1, 1, 1, 0.5), alpha_mode="blend"), True),
    (Material(alpha_mode="blend"), False),
    (Material(alpha_mode="mask", base_color=(1, 1, 1, 0.5), alpha_cutoff=0.5), False),
    (Material(alpha_mode="mask", base_color=(1, 1, 1, 0.4), alpha_cutoff=0.5), True),
    (Material(alpha_mode="mask", base_color_texture=Texture(image_of(noise(2, 2, 4)))), True),
    (Material(alpha_mode="blend", base_color_texture=Texture(image_of(noise(2, 2, 3)))), False),
])
def test_only_what_may_be_see_through_is(material, is_see_through):
    assert trace_geometry(scene(plate(), materials=(material,))).instances[0].see_through == is_see_through


def test_vertex_colours_may_be_see_through():
    faded = replace(plate(), colors=np.float32([[1, 1, 1, 0]] * 4))
    assert trace_geometry(scene(faded, materials=(Material(alpha_mode="blend"),))).instances[0].see_through


def test_emissive_triangles_are_numbered():
    lamp = Material(emissive=(1, 0, 0))
    one = scene(plate(1), plate(0), plate(2), plate(1), materials=(Material(), lamp, replace(lamp, unlit=True)))
    geometry = trace_geometry(one)
    assert [i.first_emitter for i in geometry.instances] == [0, -1, -1, 2] and geometry.emitters == 4


def test_what_a_mesh_lacks_makes_a_material_of_its_own():
    bare = replace(plate(), uvs=(), tangents=None)
    one = scene(plate(), bare, plate(), materials=(Material(base_color_texture=Texture(image_of(noise(2, 2)))),))
    geometry = trace_geometry(one)
    assert [i.material for i in geometry.instances] == [0, 1, 0]
    assert [len(m.color_maps) for m in geometry.materials] == [1, 0]


def test_maps_of_one_colour_are_factors():
    black, white = (io.BytesIO(), io.BytesIO())
    Image.new("RGB", (2, 2)).save(black, "PNG")
    Image.new("RGB", (2, 2), (255, 255, 255)).save(white, "PNG")
    dark, bright = (Texture(open_texture_image(data.getvalue(), "texture")) for data in (black, white))
    material = Material(base_color=(0.5, 0.5, 0.5, 1.0), base_color_texture=bright, emissive=(1, 1, 1),
                        emissive_texture=dark)
    one = scene(plate(), materials=(material,))
    geometry = trace_geometry(one)
    assert geometry.emitters == 0 and geometry.materials[0].color_maps == ()
    assert geometry.materials[0].material.base_color == (0.5, 0.5, 0.5, 1.0)
    assert unused_maps(one, geometry) == ["2 material maps of one colour: folded into factors"]
