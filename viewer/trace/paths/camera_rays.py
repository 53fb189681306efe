"""The uniforms of shaders/trace/camera.glsl, whose rays are exact for any distance of the eye."""

from __future__ import annotations

import numpy as np

from ...gpu.programs import matrix_uniform
from ...scene.camera import Camera
from ...scene.frame import Frame
from ...scene.scene import Scene

NEAR = 4.0
"""If the eye is at most this far from the centre, in tracer units, rays start at the eye."""
INFINITE = 1e30
INFINITE_EYE = 1e3
EYE_BALL = 0.05
"""Radius of a ball about the eye, over the distance of the eye or the radius of the scene if that is larger."""


def camera_uniforms(scene: Scene, camera: Camera, size: tuple[int, int], every: int = 1) -> dict[str, object]:
    """Uniforms for pictures of `size` (width, height), framed as viewer/scene/frame.py does, of which each `every`'th
    pixel of a row and of a column is traced; the first is the middle one of the first so many.

    The shader makes a ray from the point where it crosses a plane through the scene's centre. The distance of the eye
    from that plane may be a million times the extent of the picture, so the computation with it is done here in
    float64. An orthographic camera also sees what is behind its eye, as in the raster. For photons the uniforms of
    shaders/trace/connect.glsl, which find a point's pixel, are computed in the same way.
    """
    frame = Frame(scene, camera, size)
    ray = frame.ray
    eye = (camera.eye - scene.center) / scene.radius
    project, project_from, unit = projection(scene, camera, size)
    depth = -float(eye @ camera.forward)
    if camera.height is not None:
        plane = frame.ray_origin.copy()
        plane[:, 2] += eye + depth * camera.forward
        start = INFINITE
        area = np.linalg.norm(np.cross(plane[:, 0], plane[:, 1]))
    else:
        start = depth if depth > 0 and np.linalg.norm(eye) > NEAR else 0.0
        plane = ray * start
        plane[:, 2] += eye
        area = np.linalg.norm(np.cross(ray[:, 0], ray[:, 1])) * unit * unit
    return {
        "u_camera_pixel": (2 / size[0], 2 / size[1]),
        "u_camera_ray": matrix_uniform(ray),
        "u_camera_plane": matrix_uniform(plane),
        "u_camera_depth": start,
        "u_camera_eye": tuple(eye.tolist()),
        "u_camera_forward": tuple(camera.forward.tolist()) if camera.height is not None else (0.0, 0.0, 0.0),
        "u_camera_unit": scene.radius,
        "u_camera_skip": (every - 1, every // 2),
        "u_camera_size": (size[0] // every, size[1] // every),
        "u_camera_project": matrix_uniform(project),
        "u_camera_project_from": tuple(project_from.tolist()),
        "u_camera_pixel_area": float(area * 4 / (size[0] * size[1])),
        "u_eye_ball": _eye_ball(camera, eye),
    }


def projection(scene: Scene, camera: Camera, size: tuple[int, int]) -> tuple[np.ndarray, np.ndarray, float]:
    """The (3, 3) float64 matrix and the (3,) vector that take a point p of tracer space to (x w, y w, w), x and y in
    normalised device coordinates, by `matrix @ p + vector`, and the length of a unit of the depth w. An orthographic
    camera has the depth 1 everywhere."""
    frame = Frame(scene, camera, size)
    eye = (camera.eye - scene.center) / scene.radius
    depth = -float(eye @ camera.forward)
    if camera.height is not None:
        plane = frame.ray_origin.copy()
        plane[:, 2] += eye + depth * camera.forward
        matrix = np.linalg.inv(np.stack([plane[:, 0], plane[:, 1], camera.forward], axis=1))
        vector = -matrix @ plane[:, 2]
        matrix[2], vector[2] = 0.0, 1.0
        return matrix, vector, 1.0
    unit = max(depth, 1.0)  # so that float32 does not lose digits to a large distance
    matrix = np.linalg.inv(frame.ray) / unit
    return matrix, -matrix @ eye, unit


def _eye_ball(camera: Camera, eye: np.ndarray) -> tuple[float, ...]:
    """Centre and radius of a ball about `eye` that so many photons meet that their light can be measured. The eye of an
    orthographic camera is far away for this."""
    center = eye if camera.height is None else -INFINITE_EYE * camera.forward
    return *center.tolist(), EYE_BALL * max(float(np.linalg.norm(center)), 1.0)
