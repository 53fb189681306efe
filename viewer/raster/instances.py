"""Where the instances of a mesh stand, as attributes of one call that draws them all."""

from __future__ import annotations

import moderngl
import numpy as np

from ..scene.scene import Scene
from ..scene.transform import normals_and_hands

_FIXED = {"a_model_x": 3, "a_model_y": 3, "a_model_z": 3, "a_normal_x": 3, "a_normal_y": 3, "a_normal_z": 3,
          "a_instance": 1}
"""The attributes that do not depend on the camera, in the order of a record, with their floats: the columns of the
matrices of shaders/raster/placement.glsl, and the number from 1."""

MOST_VERTICES = 1 << 19
"""In one call. Software OpenGL holds all of a call until it is drawn, in about 170 bytes a vertex."""

Content = tuple[object, ...]
"""A buffer, its format and its attributes, as moderngl takes them for a vertex array."""


class InstanceBuffers:
    """`count` instances of one mesh, all mirrored (`hand` is -1) or none (1).

    Where they stand relative to an origin is worked out in float64 and rounded last, as for a mesh that is drawn alone.
    So it is uploaded for each place of the camera, and all else only where other ones are seen.
    """

    def __init__(self, gl: moderngl.Context, hand: float, count: int, vertices: int) -> None:
        """`vertices` are those of the mesh."""
        self.hand, self.count = hand, count
        self.is_large = 2 * count * vertices > MOST_VERTICES
        self._buffers = [gl.buffer(reserve=4 * floats * count, dynamic=True) for floats in (sum(_FIXED.values()), 3)]

    def place(self, scene: Scene, numbers: np.ndarray, to_mesh: np.ndarray, normals: np.ndarray) -> None:
        """Take the places of the instances `numbers` (count,) of a scene. `to_mesh` takes what the buffers of the mesh
        have to the mesh, and `normals` has the matrices of normals, (count, 3, 3)."""
        self._numbers, self._scale = numbers, 1 / scene.radius
        models = scene.transforms[numbers] @ to_mesh
        self._places = models[:, :3, 3] * self._scale
        columns = (models[:, :3, :3] * self._scale).transpose(0, 2, 1), normals.transpose(0, 2, 1)
        self._fixed = np.concatenate([*(part.reshape(-1, 9) for part in columns), numbers[:, None] + 1.0],
                                     axis=1).astype(np.float32)
        self._seen: np.ndarray | None = None

    def show(self, origin: np.ndarray, visible: np.ndarray | None = None) -> int:
        """Upload those that are `visible` of all instances of the scene, by default all, as they stand about `origin`,
        (3,) in world space. Returns how many there are."""
        seen = np.ones(self.count, bool) if visible is None else visible[self._numbers]
        fixed, places = self._buffers
        if self._seen is None or not np.array_equal(seen, self._seen):
            self._seen = seen
            fixed.write(self._fixed[seen])
        places.write((self._places[seen] + -origin * self._scale).astype(np.float32))
        return int(seen.sum())

    def content(self, program: moderngl.Program) -> list[Content]:
        """The attributes of these that `program` reads, one of each for an instance."""
        fixed, places = self._buffers
        read = [name for name in _FIXED if name in program]
        parts = " ".join(f"{floats}f" if name in read else f"{4 * floats}x" for name, floats in _FIXED.items())
        return [(fixed, f"{parts}/i", *read), (places, "3f/i", "a_model_w")]

    @property
    def key(self) -> tuple[int, ...]:
        """What tells vertex arrays of these from those of others, as long as they are not released."""
        return tuple(buffer.glo for buffer in self._buffers)

    def release(self) -> None:
        for buffer in self._buffers:
            buffer.release()


def parts_of(scene: Scene, numbers: tuple[int, ...], vertices: int) -> list[tuple[float, np.ndarray, np.ndarray]]:
    """The instances `numbers` of a mesh of so many vertices, those that are not mirrored and those that are, in parts
    of at most MOST_VERTICES: handedness, numbers (K,) and matrices of normals (K, 3, 3)."""
    whole = np.array(numbers)
    normals, hands = normals_and_hands(scene.transforms[whole])
    most = max(MOST_VERTICES // max(vertices, 1), 1)
    parts = []
    for hand in (1.0, -1.0):
        which = np.flatnonzero(hands == hand)
        parts += [(hand, whole[part], normals[part]) for part in np.split(which, range(most, len(which), most))]
    return [part for part in parts if len(part[1])]
