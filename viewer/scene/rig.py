"""The rig of a scene: the nodes of its file, and what of the scene each of them places or deforms."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from .animation import Target
from .camera import pose_of
from .deform import Deformation
from .mesh import Mesh

if TYPE_CHECKING:
    from .moving_curves import MovingCurves


@dataclass(frozen=True, eq=False)
class Nodes:
    """The hierarchy at rest. All arrays are (N, ...) float64, but for `parents`, which has -1 for a root.

    A node's local matrix is `matrices[n]` if it has one, and else translation * rotation * scale. Rotations are unit
    quaternions x, y, z, w. `depth` is 0 for a root, and for others one more than their parents'. A node that is not
    `visible` (N,) bool hides the meshes and lights of its own and of all nodes below it; by default all are visible.
    """

    parents: np.ndarray
    depth: np.ndarray
    translations: np.ndarray
    rotations: np.ndarray
    scales: np.ndarray
    matrices: dict[int, np.ndarray]
    visible: np.ndarray = field(default_factory=lambda: np.zeros(0, bool))

    def __post_init__(self) -> None:
        if not len(self.visible):
            object.__setattr__(self, "visible", np.ones(len(self.parents), bool))

    @cached_property
    def at_rest(self) -> np.ndarray:
        """The local matrices at rest, (N, 4, 4)."""
        local = compose(self.translations, self.rotations, self.scales)
        for node, matrix in self.matrices.items():
            local[node] = matrix
        return local

    @cached_property
    def levels(self) -> list[np.ndarray]:
        """The nodes by depth: roots, their children, and so on."""
        order = np.argsort(self.depth, kind="stable")
        return np.split(order, np.flatnonzero(np.diff(self.depth[order])) + 1)

    def world(self, local: np.ndarray) -> np.ndarray:
        """Each node's matrix to world space, (N, 4, 4), from the local ones."""
        world = local.copy()
        for nodes in self.levels[1:]:
            world[nodes] = world[self.parents[nodes]] @ local[nodes]
        return world

    def hidden(self, visible: np.ndarray) -> np.ndarray:
        """The nodes, (N,) bool, that are not visible or are below one that is not."""
        hidden = ~visible
        for nodes in self.levels[1:]:
            hidden[nodes] |= hidden[self.parents[nodes]]
        return hidden


@dataclass(frozen=True, eq=False)
class Skin:
    """`joints` (J,) are nodes; `inverse_bind` (J, 4, 4) float64 takes the mesh at rest to each joint's space."""

    joints: np.ndarray
    inverse_bind: np.ndarray

    def matrices(self, world: np.ndarray) -> np.ndarray:
        """From the mesh at rest to the world by each joint, (J, 4, 4)."""
        return world[self.joints] @ self.inverse_bind


@dataclass(frozen=True, eq=False)
class Deformed:
    """A mesh of the scene that morph targets or a skin deform. `node` has the weights, which are `weights` at rest."""

    rest: Mesh
    deformation: Deformation
    node: int
    weights: tuple[float, ...] = ()
    skin: Skin | None = None

    def at(self, weights: tuple[float, ...], world: np.ndarray) -> Mesh:
        """The mesh with these weights, under nodes with these matrices to the world, (N, 4, 4).

        Raises UsageError if a vertex comes where no float32 is.
        """
        matrices = None if self.skin is None else self.skin.matrices(world)
        return self.deformation.applied(self.rest, weights, matrices)


@dataclass(frozen=True, eq=False)
class Rig:
    """What of the scene moves, and what moves it.

    `instances`, `lights` and `cameras` have the node of each of the scene's. The instances that `is_skinned` are placed
    by the joints of a skin and not by their node; the others have a matrix to their node in `offsets` (I, 4, 4), unless
    that is None. Lights and cameras that were added to the scene follow these. `deformed` has the meshes that move in
    themselves, by their number, and `curves` the first curves of the scene. Tracks name lights, cameras and materials
    by their numbers in the file: `light_items` and `camera_items` have that number of each of the scene's, and so have
    `materials`, with -1 for none. `at_rest` has the values at rest of what tracks move beside nodes.
    """

    nodes: Nodes
    instances: np.ndarray
    lights: tuple[int, ...] = ()
    cameras: tuple[int, ...] = ()
    deformed: dict[int, Deformed] = field(default_factory=dict)
    light_items: tuple[int, ...] = ()
    camera_items: tuple[int, ...] = ()
    materials: tuple[int, ...] = ()
    at_rest: dict[Target, np.ndarray] = field(default_factory=dict)
    is_skinned: np.ndarray | None = None
    offsets: np.ndarray | None = None
    curves: tuple[MovingCurves, ...] = ()

    def transforms(self, world: np.ndarray, hidden: np.ndarray) -> np.ndarray:
        """The instances' matrices to the world, (I, 4, 4), from those of nodes and from which of these are hidden.

        What is hidden is shrunk to a point, so that it draws nothing.
        """
        out = world[self.instances]
        if self.is_skinned is not None:
            out[self.is_skinned] = np.eye(4)
        if self.offsets is not None:
            out = out @ self.offsets
        out[hidden[self.instances], :3, :3] = 0.0
        return out


def compose(translations: np.ndarray, rotations: np.ndarray, scales: np.ndarray) -> np.ndarray:
    """Matrices (N, 4, 4) of translation * rotation * scale, from (N, 3), unit quaternions (N, 4), (N, 3)."""
    x, y, z, w = rotations.T
    out = np.zeros((len(rotations), 4, 4))
    out[:, 0, 0], out[:, 0, 1], out[:, 0, 2] = 1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)
    out[:, 1, 0], out[:, 1, 1], out[:, 1, 2] = 2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)
    out[:, 2, 0], out[:, 2, 1], out[:, 2, 2] = 2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)
    out[:, :3, :3] *= scales[:, None, :]
    out[:, :3, 3], out[:, 3, 3] = translations, 1.0
    return out


def camera_pose(world: np.ndarray) -> np.ndarray:
    """The rigid pose of a camera at a node with this matrix to the world, (4, 4); scale and shear are ignored.

    The node's -Z is the view direction, and its +Y defines "up".
    """
    back = _unit(world[:3, 2])
    return pose_of(world[:3, 3], back if back.any() else np.array([0.0, 0.0, 1.0]), world[:3, 1])


def light_direction(world: np.ndarray) -> tuple[float, float, float]:
    """The direction in which a light at this node shines: its -Z, at length 1."""
    direction = -_unit(world[:3, 2])
    x, y, z = (direction if direction.any() else np.array([0.0, 0.0, -1.0])).tolist()
    return x, y, z


def _unit(vector: np.ndarray) -> np.ndarray:
    peak = np.abs(vector).max()
    return vector / peak / np.linalg.norm(vector / peak) if peak > 0 else vector
