"""Scenes with little or nothing in them, for every renderer to survive."""

from __future__ import annotations

import numpy as np
from shapes import moved, scene, sphere

from viewer.scene.camera import Camera
from viewer.scene.mesh import Mesh
from viewer.scene.scene import Scene


def framing(model: Scene) -> Camera:
    return Camera.framing(model.center, model.radius, 1.0)


def cloud(topology: str, points) -> Mesh:
    return Mesh(topology, np.float32(points), 0, topology=topology)


NOTHING_MUCH = {
    "empty": Scene("empty"),
    "no triangles": scene(cloud("lines", [[0, 0, 0], [1, 1, 0], [0, 1, 0], [1, 0, 1]])),
    "a single point": scene(cloud("points", [[3, 2, 1]])),
    "a triangle of no size": scene(Mesh("dot", np.float32([[1, 1, 1]] * 3), 0, normals=np.float32([[0, 0, 1]] * 3))),
    "a scale of 0": scene((sphere(segments=12), moved((1, 2, 3), 0.0))),
    "a flat scale": scene((sphere(segments=12), moved((0, 0, 0), (1, 0, 1)))),
}
