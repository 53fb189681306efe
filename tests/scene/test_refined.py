"""Coarse meshes, divided for light that is stored at vertices."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from shapes import moved, plate, scene, sphere

from viewer.scene.refined import LONGEST, MOST_TRIANGLES, refined
from viewer.scene.triangles import triangles_of


def test_a_coarse_mesh_has_short_edges_and_the_same_surface():
    mesh = replace(plate(), colors=np.float32([[0, 0, 0, 1], [1, 0, 0, 1], [1, 1, 0, 1], [0, 1, 0, 1]]))
    model = scene((mesh, moved((0, 0, 0), (3.0, -1.0, 1.0))), sphere(segments=96))
    fine = refined(model).meshes[0]
    corners = fine.positions[triangles_of(fine)].astype(np.float64)
    edges = (corners - np.roll(corners, 1, axis=1)) * [3, 1, 1]
    assert np.linalg.norm(edges, axis=2).max() <= LONGEST * model.radius * (1 + 1e-6)
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert np.isclose(cross[:, 2].sum() / 2, 4) and cross[:, 2].min() > 0
    x, y = fine.positions[:, 0], fine.positions[:, 1]
    assert np.allclose(fine.uvs[0], np.stack([(1 + x) / 2, (1 - y) / 2], axis=1), atol=1e-6)
    assert np.allclose(fine.colors, np.stack([(1 + x) / 2, (1 + y) / 2, 0 * x, 1 + 0 * x], axis=1), atol=1e-6)
    assert (fine.normals == [0, 0, 1]).all() and (fine.tangents == [1, 0, 0, 1]).all()
    assert len(np.unique(fine.positions, axis=0)) == len(fine.positions)
    pairs = np.sort(np.stack([triangles_of(fine), np.roll(triangles_of(fine), -1, axis=1)], axis=2), axis=2)
    pairs, count = np.unique(pairs.reshape(-1, 2), axis=0, return_counts=True)
    borders = fine.positions[pairs[count == 1], :2]
    assert (np.abs(borders).min(axis=1) == 1).any(axis=1).all(), "an edge ends within another"
    assert count.max() == 2


def test_only_long_edges_are_divided():
    strip = replace(plate(), positions=plate().positions * np.float32([50, 1, 1]))
    model = scene((strip, moved((0, 0, 0))), sphere(segments=96))
    fine = refined(model).meshes[0]
    corners = fine.positions[triangles_of(fine)]
    edges = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2)
    longest = 2.0 ** np.floor(np.log2(LONGEST * model.radius))
    assert edges.max() <= longest < 2 * edges.max(axis=1).min() and fine.triangle_count < 2048


def test_scenes_share_what_is_divided():
    model = scene(plate(), (sphere(), moved((0, 0, 3))))
    fine = refined(model)
    assert fine is refined(model) and fine.meshes[1] is model.meshes[1]
    relit = refined(replace(model, name="relit"))
    assert relit.meshes[0] is fine.meshes[0] and relit.has_surfaces_of(fine)
    assert refined(fine) is fine


def test_convex_scenes_stay_as_they_are():
    model = scene(plate())
    assert refined(model) is model


def test_no_mesh_has_more_triangles_than_the_most_or_its_own():
    for mesh in (sphere(segments=12), sphere(segments=40), sphere(segments=96)):
        fine = refined(scene((mesh, moved((0, 0, 0))), (plate(), moved((0, 0, 0), 0.01)))).meshes[0]
        assert fine.triangle_count <= max(MOST_TRIANGLES, mesh.triangle_count)
