import numpy as np

from viewer.scene.normals import creased_normals, flat_normals, smooth_normals

CUBE = np.array([[x, y, z] for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)], np.float32)
CUBE_TRIANGLES = np.array([[0, 2, 1], [1, 2, 3], [4, 5, 6], [5, 7, 6], [0, 1, 4], [1, 5, 4],
                           [2, 6, 3], [3, 6, 7], [0, 4, 2], [2, 4, 6], [1, 3, 5], [3, 7, 5]])


def test_flat_normals_face_outwards_and_survive_degenerate_triangles():
    normals = flat_normals(CUBE[CUBE_TRIANGLES].reshape(-1, 3)).reshape(-1, 3, 3)
    centers = CUBE[CUBE_TRIANGLES].mean(axis=1)
    axis = np.abs(centers).argmax(axis=1)
    np.testing.assert_array_equal(normals[np.arange(12), 0, axis], np.sign(centers[np.arange(12), axis]))
    assert flat_normals(np.zeros((3, 3), np.float32)).tolist() == [[0, 0, 1]] * 3


def test_smooth_normals_weigh_by_angle_not_by_triangulation():
    # A corner of a cube meets 3 right angles, however many triangles share each.
    normals = smooth_normals(CUBE, CUBE_TRIANGLES)
    np.testing.assert_allclose(normals, CUBE / np.sqrt(3), atol=1e-6)


def test_creases_stay_sharp_and_the_rest_smooth():
    cube = creased_normals(CUBE, CUBE_TRIANGLES)
    np.testing.assert_allclose(cube, np.repeat(cube[:, :1], 3, axis=1), atol=1e-6)
    # A prism of 24 sides turns by 15 degrees from side to side: smooth around, sharp at the caps (of which one here).
    n = 24
    angle = np.arange(n) / n * 2 * np.pi
    ring = np.stack([np.cos(angle), np.sin(angle), np.zeros(n)], axis=1)
    points = np.concatenate([ring, ring + (0, 0, 1), [[0, 0, 1]]]).astype(np.float32)
    i, j = np.arange(n), (np.arange(n) + 1) % n
    side = np.concatenate([np.stack([i, j, j + n], 1), np.stack([i, j + n, i + n], 1)])
    cap = np.stack([i + n, j + n, np.full(n, 2 * n)], 1)
    triangles = np.concatenate([side, cap])
    normals = creased_normals(points, triangles)
    np.testing.assert_allclose(normals[:2 * n], points[triangles[:2 * n]] * (1, 1, 0), atol=1e-6)
    np.testing.assert_allclose(normals[2 * n:], np.broadcast_to((0, 0, 1), (n, 3, 3)), atol=1e-6)


def test_seams_in_the_numbering_leave_no_mark():
    doubled = np.concatenate([CUBE, CUBE])
    triangles = CUBE_TRIANGLES.copy()
    triangles[::2] += 8
    np.testing.assert_allclose(creased_normals(doubled, triangles, np.pi), creased_normals(CUBE, CUBE_TRIANGLES, np.pi),
                               atol=1e-6)
