import numpy as np

from viewer.scene.tangents import any_tangents, make_tangents

QUAD = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], np.float32)
QUAD_UV = np.array([[0, 1], [1, 1], [1, 0], [0, 0]], np.float32)  # v down: upright to the eye
QUAD_TRIANGLES = np.array([[0, 1, 2], [0, 2, 3]])
UP = np.tile(np.float32([0, 0, 1]), (4, 1))


def test_upright_texture_has_w_plus_one_and_its_bitangent_upwards():
    source, tangents, triangles = make_tangents(QUAD, UP, QUAD_UV, QUAD_TRIANGLES)
    np.testing.assert_allclose(tangents, np.tile([1, 0, 0, 1], (4, 1)), atol=1e-6)
    np.testing.assert_array_equal(source, range(4))
    np.testing.assert_array_equal(triangles, QUAD_TRIANGLES)
    bitangent = tangents[:, 3:] * np.cross(UP, tangents[:, :3])
    np.testing.assert_allclose(bitangent, np.tile([0, 1, 0], (4, 1)), atol=1e-6)


def test_mirrored_texture_has_w_minus_one():
    _, tangents, _ = make_tangents(QUAD, UP, QUAD_UV * (-1, 1), QUAD_TRIANGLES)
    np.testing.assert_allclose(tangents, np.tile([-1, 0, 0, -1], (4, 1)), atol=1e-6)


def test_vertices_between_mirrored_halves_are_split():
    positions = np.array([[-1, 0, 0], [0, 0, 0], [1, 0, 0], [-1, 1, 0], [0, 1, 0], [1, 1, 0]], np.float32)
    uv = np.array([[1, 1], [0, 1], [1, 1], [1, 0], [0, 0], [1, 0]], np.float32)
    triangles = np.array([[0, 1, 4], [0, 4, 3], [1, 2, 5], [1, 5, 4]])
    source, tangents, new = make_tangents(positions, np.tile(np.float32([0, 0, 1]), (6, 1)), uv, triangles)
    np.testing.assert_array_equal(source, [0, 1, 2, 3, 4, 5, 1, 4])
    np.testing.assert_array_equal(source[new], triangles)
    np.testing.assert_allclose(tangents[new[:2].ravel()], np.tile([-1, 0, 0, -1], (6, 1)), atol=1e-6)
    np.testing.assert_allclose(tangents[new[2:].ravel()], np.tile([1, 0, 0, 1], (6, 1)), atol=1e-6)


def test_degenerate_uvs_get_a_perpendicular_unit_vector():
    rng = np.random.default_rng(3)
    normals = rng.normal(size=(4, 3)).astype(np.float32)
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    _, tangents, _ = make_tangents(QUAD, normals, np.zeros((4, 2), np.float32), QUAD_TRIANGLES)
    np.testing.assert_allclose(np.linalg.norm(tangents[:, :3], axis=1), 1, atol=1e-6)
    np.testing.assert_allclose((tangents[:, :3] * normals).sum(axis=1), 0, atol=1e-6)


def test_degenerate_face_takes_its_neighbours_tangent():
    uv = QUAD_UV.copy()
    uv[3] = uv[2]  # the second triangle loses its texture area
    _, tangents, new = make_tangents(QUAD, UP, uv, QUAD_TRIANGLES)
    np.testing.assert_allclose(tangents[new[1, :2]], np.tile([1, 0, 0, 1], (2, 1)), atol=1e-6)


def test_unindexed_and_indexed_meshes_agree():
    """On a curved surface with a seam: corners of the same vertex share a tangent though their numbers differ."""
    n = 16
    t, h = np.meshgrid(np.linspace(0, 2 * np.pi, n + 1), np.linspace(0, 1, 5))
    radius = 1 + 0.3 * h
    positions = np.stack([radius * np.cos(t), h, -radius * np.sin(t)], -1).reshape(-1, 3).astype(np.float32)
    normals = np.stack([np.cos(t), -0.3 + 0 * h, -np.sin(t)], -1).reshape(-1, 3)
    normals = (normals / np.linalg.norm(normals, axis=1, keepdims=True)).astype(np.float32)
    uv = np.stack([t / 6 + 0.2 * h, 1 - h], -1).reshape(-1, 2).astype(np.float32)
    a = (np.arange(4)[:, None] * (n + 1) + np.arange(n)).ravel()
    triangles = np.concatenate([np.stack([a, a + 1, a + n + 2], 1), np.stack([a, a + n + 2, a + n + 1], 1)])
    _, indexed, new = make_tangents(positions, normals, uv, triangles)
    corner = triangles.ravel()
    _, loose, loose_new = make_tangents(positions[corner], normals[corner], uv[corner],
                                        np.arange(len(corner)).reshape(-1, 3))
    np.testing.assert_allclose(loose[loose_new], indexed[new], atol=1e-5)
    assert (indexed[:, 3] == 1).all()


def test_any_tangents_at_the_poles():
    normals = np.array([[0, 0, 1], [0, 0, -1], [0, 1, 0], [1, 0, 0]], np.float32)
    tangents = any_tangents(normals)
    np.testing.assert_allclose((tangents * normals).sum(axis=1), 0, atol=1e-7)
    np.testing.assert_allclose(np.linalg.norm(tangents, axis=1), 1, atol=1e-7)
