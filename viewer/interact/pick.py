"""Picking: finds the surface under the cursor by ray casting in float64."""

from __future__ import annotations

import numpy as np

from ..scene.camera import Camera
from ..scene.mesh import Mesh
from ..scene.scene import Scene


def cursor_ray(camera: Camera, size: tuple[int, int], cursor: tuple[float, float]) -> tuple[np.ndarray, np.ndarray]:
    """The world-space origin and unit direction of the ray through `cursor`, which is in the units of `size`, y
    downwards."""
    x, y = 2 * cursor[0] / size[0] - 1, 1 - 2 * cursor[1] / size[1]
    half, middle = camera.window(size[0] / size[1])
    offset = camera.pose[:3, :2] @ (half * (x, y) + middle)
    if camera.height is not None:
        return camera.eye + offset, camera.forward
    direction = camera.forward + offset
    return camera.eye, direction / np.linalg.norm(direction)


def pick(scene: Scene, camera: Camera, size: tuple[int, int], cursor: tuple[float, float]) -> np.ndarray | None:
    """The nearest point of a surface under the cursor, (3,) float64 in world space, or None.

    Back faces of single-sided surfaces are not hit. An orthographic camera also shows what is behind its eye, so its
    ray starts at minus infinity.
    """
    origin, direction = cursor_ray(camera, size, cursor)
    start = -np.inf if camera.height is not None else 0.0
    nearest = np.inf
    boxes = np.stack([scene.corners.min(axis=1), scene.corners.max(axis=1)], axis=1)
    enter, leave = box_intervals(boxes, origin, direction)
    crossed = np.flatnonzero((enter <= leave) & (leave >= start))
    for index in crossed[np.argsort(enter[crossed])]:
        if enter[index] >= nearest:
            break
        instance = scene.instances[index]
        mesh, linear = scene.meshes[instance.mesh], instance.transform[:3, :3]
        if mesh.topology != "triangles" or np.linalg.matrix_rank(linear) < 3:
            continue
        # In the mesh's local space the ray parameter t is the same as in world space.
        inverse = np.linalg.inv(linear)
        local_origin, local_direction = inverse @ (origin - instance.transform[:3, 3]), inverse @ direction
        double_sided = scene.materials[mesh.material].double_sided
        nearest = min(nearest, ray_mesh(mesh, local_origin, local_direction, start, double_sided))
    return origin + nearest * direction if np.isfinite(nearest) else None


def plane_point(camera: Camera, size: tuple[int, int], cursor: tuple[float, float], depth: float) -> np.ndarray:
    """The point under the cursor at `depth` in front of the eye, for pixels without a surface."""
    origin, direction = cursor_ray(camera, size, cursor)
    return origin + direction * (depth / float(direction @ camera.forward))


def box_intervals(boxes: np.ndarray, origin: np.ndarray, direction: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The ray parameters at which a ray enters and leaves boxes (N, 2, 3), each (N,). It misses a box if enter >
    leave."""
    margin = 1e-9 * (boxes[:, 1] - boxes[:, 0]).max(axis=1)[:, None]
    with np.errstate(divide="ignore", invalid="ignore"):
        a = (boxes[:, 0] - margin - origin) / direction
        b = (boxes[:, 1] + margin - origin) / direction
    # 0 / 0 is NaN: the ray lies in the plane of a side.
    a, b = np.where(np.isnan(a), -np.inf, a), np.where(np.isnan(b), np.inf, b)
    return np.minimum(a, b).max(axis=1), np.maximum(a, b).min(axis=1)


def ray_mesh(mesh: Mesh, origin: np.ndarray, direction: np.ndarray, start: float, double_sided: bool) -> float:
    """The least t > `start` at which the ray hits a visible side of the mesh; inf if there is no hit."""
    triangles = _triangles_about(mesh, origin, direction)
    a, b, c = (mesh.positions[triangles[:, k]].astype(np.float64) for k in range(3))
    # Moeller and Trumbore 1997.
    edge1, edge2, from_a = b - a, c - a, origin - a
    p, q = np.cross(direction, edge2), np.cross(from_a, edge1)
    with np.errstate(divide="ignore", invalid="ignore"):
        determinant = (edge1 * p).sum(axis=1)
        u = (from_a * p).sum(axis=1) / determinant
        v = (q @ direction) / determinant
        t = (edge2 * q).sum(axis=1) / determinant
        hit = (u >= 0) & (v >= 0) & (u + v <= 1) & (t > start)
    if not double_sided:
        hit &= determinant > 0  # the front is where the corners run counter-clockwise
    return float(t[hit].min()) if hit.any() else np.inf


def _triangles_about(mesh: Mesh, origin: np.ndarray, direction: np.ndarray) -> np.ndarray:
    """The triangles, (N, 3) indices, whose bounding box in a plane perpendicular to the ray contains the ray. This
    quick test leaves few triangles."""
    along = direction / np.linalg.norm(direction)
    side = np.cross(along, np.eye(3)[np.abs(along).argmin()])
    indices = np.arange(len(mesh.positions)) if mesh.indices is None else mesh.indices
    triangles = indices[: len(indices) // 3 * 3].reshape(-1, 3)
    candidates = np.ones(len(triangles), bool)
    for axis in (side, np.cross(along, side)):
        distance = mesh.positions @ axis - origin @ axis
        for beyond in (distance > 0, distance < 0):
            candidates &= ~beyond[triangles].all(axis=1)
    return triangles[candidates]
