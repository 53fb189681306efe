"""A scene: meshes, instances, volumes, curves, lights, cameras and an environment, as plain data without OpenGL."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, fields, replace
from functools import cached_property
from itertools import zip_longest
from numbers import Integral, Real
from types import NoneType
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..base.expect import existing, expect, expect_index, expect_number
from ..errors import UsageError
from . import extent, framing, override
from .animation import Animation
from .arrays import HoldsArrays, scene_array
from .camera import DEFAULT_AZIMUTH, DEFAULT_ELEVATION, DEFAULT_FOV, Camera
from .curves import Curves
from .environment import Environment
from .light import Light
from .material import Material
from .mesh import Mesh
from .rig import Rig
from .schema import MAPS
from .texture_image import TextureImage
from .volume import Volume

MAX_EXTENT = 1e18
"""The largest coordinate. Its square must fit in a float32, in which shaders compute distances."""


@dataclass(frozen=True, eq=False)
class Instance(HoldsArrays):
    """A mesh placed in the world; `transform` is (4, 4) float64, column vectors (world = transform @ local)."""

    mesh: int
    transform: np.ndarray
    name: str = ""

    def __post_init__(self) -> None:
        expect_index(self.mesh, "Instance.mesh", "a mesh")
        expect(self.name, str, "Instance.name", "text")
        self._set("transform", scene_array(self.transform, "Instance.transform", np.float64, 4, 4))
        if self.transform[3].tolist() != [0, 0, 0, 1]:
            raise UsageError(f"Instance.transform[3] is {self.transform[3].tolist()}, not 0, 0, 0, 1")


@dataclass(frozen=True, eq=False)
class Variant:
    """A choice of materials: one for each of the scene's, and each one's number in the file, -1 for none."""

    name: str
    materials: tuple[Material, ...]
    numbers: tuple[int, ...]


@dataclass(frozen=True, eq=False, repr=False)
class Scene:
    """Everything that is shown. Meshes refer to materials by index, and instances to meshes.

    `warnings` are lines for the user about what of the file is not supported. `rig` has what `animations` move, None if
    there are none; `at` is the scene at another time.
    """

    name: str
    meshes: tuple[Mesh, ...] = ()
    materials: tuple[Material, ...] = ()
    instances: tuple[Instance, ...] = ()
    lights: tuple[Light, ...] = ()
    cameras: tuple[Camera, ...] = ()
    environment: Environment | None = None
    warnings: tuple[str, ...] = ()
    facts: dict[str, object] = field(default_factory=dict)
    """Metadata of the file, for `pbr-viewer info`: format, generator, extensions used."""
    animations: tuple[Animation, ...] = ()
    rig: Rig | None = None
    variants: tuple[Variant, ...] = ()
    """The choices of materials that the file offers. The first has no name and is shown unless another is chosen; there
    is none where there is no choice."""
    variant: str = ""
    """The name of the one that is shown."""
    volumes: tuple[Volume, ...] = ()
    curves: tuple[Curves, ...] = ()

    def __post_init__(self) -> None:
        expect(self.name, str, "Scene.name", "text")
        for name, kind, wanted in (
                ("meshes", Mesh, "a Mesh"), ("materials", Material, "a Material"),
                ("instances", Instance, "an Instance"), ("lights", Light, "a Light"),
                ("cameras", Camera, "a Camera"), ("curves", Curves, "Curves"),
                ("animations", Animation, "an Animation"), ("variants", Variant, "a Variant"),
                ("volumes", Volume, "a Volume (Volume.in_box makes one of an array)")):
            values = getattr(self, name)
            expect(values, (tuple, list), f"Scene.{name}", f"a tuple of {name}")
            for k, value in enumerate(values):
                if type(value) is not kind:  # so that a million names are not formatted in vain
                    expect(value, kind, f"Scene.{name}[{k}]", wanted)
        expect(self.environment, (Environment, NoneType), "Scene.environment",
               "an Environment or None (viewer.load and viewer.scene make one of a name)")
        for k, mesh in enumerate(self.meshes):
            if not 0 <= mesh.material < len(self.materials):
                raise UsageError(f"Scene.meshes[{k}]: material {mesh.material}, but {existing(len(self.materials))}")
        for k, instance in enumerate(self.instances):
            if not 0 <= instance.mesh < len(self.meshes):
                raise UsageError(f"Scene.instances[{k}]: mesh {instance.mesh}, but {existing(len(self.meshes))}")

    def __repr__(self) -> str:
        """In one line: the arrays would fill pages."""
        counted = ("meshes", "materials", "instances", "volumes", "curves", "lights", "cameras")
        counts = {name: len(getattr(self, name)) for name in counted}
        words = ", ".join(f"{count} {name}" for name, count in counts.items() if count)
        light = self.environment.name if self.environment is not None else None
        return f"<Scene {self.name!r}: {words or 'empty'}, environment {light!r}>"

    @cached_property
    def bounds(self) -> np.ndarray:
        """The lowest and highest corner of the boxes of all instances, volumes and curves, (2, 3) float64; a unit cube
        about the origin if there are none.

        Triangles and lines that a scale of 0 shrinks to a point draw nothing, and are left out if anything else is
        there.
        """
        corners = np.concatenate([self.corners[self.has_extent].reshape(-1, 3), self.volume_corners,
                                  self.curve_corners])
        if not len(corners):
            return np.array([[-0.5] * 3, [0.5] * 3])
        return np.stack([corners.min(axis=0), corners.max(axis=0)])

    @cached_property
    def corners(self) -> np.ndarray:
        """The corners of each instance's bounding box in world space, (instances, 8, 3) float64."""
        if not self.instances:
            return np.zeros((0, 8, 3))
        used, place = np.unique([instance.mesh for instance in self.instances], return_inverse=True)
        boxes = np.stack([_box_corners(self.meshes[mesh].bounds) for mesh in used])[place]
        transforms = self.transforms
        return boxes @ transforms[:, :3, :3].transpose(0, 2, 1) + transforms[:, None, :3, 3]

    @cached_property
    def volume_corners(self) -> np.ndarray:
        """The corners of all volumes' boxes in world space, (8 volumes, 3) float64."""
        return np.concatenate([np.zeros((0, 3)), *(volume.corners for volume in self.volumes)])

    @cached_property
    def curve_corners(self) -> np.ndarray:
        """The corners of the boxes about all curves in world space, (8 curves, 3) float64."""
        return np.concatenate([np.zeros((0, 3)), *(curves.corners for curves in self.curves)])

    @property
    def images(self) -> tuple[TextureImage, ...]:
        """The images of all materials, each once."""
        textures = (m.texture(material) for material in self.materials for m in MAPS.values())
        return tuple(dict.fromkeys(texture.image for texture in textures if texture is not None))

    @property
    def all_warnings(self) -> tuple[str, ...]:
        """`warnings`, those of the environment, and of each texture that did not decode when it was drawn."""
        lost = (f"{problem}; the texture is left out" for image in self.images for problem in image.problems)
        environment = self.environment.warnings if self.environment is not None else ()
        return tuple(dict.fromkeys((*self.warnings, *environment, *lost)))

    @cached_property
    def has_extent(self) -> np.ndarray:
        """For each instance whether it may draw something, (instances,) bool; all of them if nothing does."""
        is_points = np.array([self.meshes[i.mesh].topology == "points" for i in self.instances], bool)
        has = is_points | (np.ptp(self.corners, axis=1) > 0).any(axis=1)
        return has if has.any() or self.volumes or self.curves else ~has

    @cached_property
    def alike(self) -> np.ndarray:
        """A number for each instance, the same for those of one mesh that only a translation tells apart, (I,)."""
        linear = self.transforms[:, :3, :3].reshape(-1, 9) + 0.0  # -0 is 0
        keys = np.column_stack([linear, [instance.mesh for instance in self.instances]])
        rows = np.ascontiguousarray(keys).view(np.dtype((np.void, keys.dtype.itemsize * keys.shape[1]))).ravel()
        return np.unique(rows, return_inverse=True)[1].ravel()

    @cached_property
    def center(self) -> np.ndarray:
        return self.bounds.mean(axis=0)

    @cached_property
    def radius(self) -> float:
        """The radius of the sphere about `center` that encloses all vertices, curves and corners of volumes. It is
        never 0, so it can be a divisor."""
        return extent.enclosing_radius(self)

    def farthest(self, direction: np.ndarray) -> np.ndarray:
        """The drawn vertex, point of a curve's surface or corner of a volume that lies farthest along `direction`,
        relative to `center`, (3,) float64."""
        return extent.farthest(self, direction)

    def framing_camera(self, aspect: float, azimuth: float = DEFAULT_AZIMUTH, elevation: float = DEFAULT_ELEVATION,
                       fov_y: float = DEFAULT_FOV, target: ArrayLike | None = None, *,
                       orthographic: bool = False) -> Camera:
        """The camera that the scene fills, seen from `azimuth` and `elevation` (radians, see `Camera.orbit`).

        `aspect` is width / height of the picture. At each side, 5 % of the width or of the height stay free. A
        `target`, (3,) in world space, is in the middle of the picture. The distance depends on the direction; for one
        that does not, take `Camera.framing(scene.center, scene.radius, ...)`.
        """
        return framing.camera(self, aspect, azimuth, elevation, fov_y, target, orthographic)

    def relit(self, **changes: Any) -> Scene:
        """A copy with another `environment`, `lights` or `materials`. It keeps the cached bounds of the geometry.

        Lights may be added behind those of the file. If those of the file are changed, none of them moves any more.
        """
        copy, rig = replace(self, **changes), self.rig
        if rig is not None and any(a is not b for a, b in zip_longest(self.lights[:len(rig.lights)],
                                                                       copy.lights[:len(rig.lights)])):
            copy = replace(copy, rig=replace(rig, lights=(), light_items=()))
        for name in ("bounds", "corners", "volume_corners", "curve_corners", "center", "radius"):
            if name in self.__dict__:
                copy.__dict__[name] = self.__dict__[name]
        return copy

    def with_material(self, material: Material) -> Scene:
        """The scene with one material on all meshes, without vertex colours and variants. Curves keep their fibres."""
        return override.with_material(self, material)

    def with_curve_radius(self, radius: float) -> Scene:
        """The scene with curves of this radius, in its unit of length; as it is if that is 0 or there are no curves.
        Two calls with one radius return the same object, and the curves are the same in all poses and lights."""
        expect_number(radius, "radius", 0.0, is_finite=True)
        if radius == 0 or not self.curves:
            return self
        known: dict[float, Scene] = self.__dict__.setdefault("_thick", {})
        if radius not in known:
            known.clear()
            known[radius] = replace(self, curves=tuple(curves.with_radius(radius) for curves in self.curves))
        return known[radius]

    def at(self, time: float, animation: str | int | None = 0) -> Scene:
        """The scene as it is `time` seconds into an animation, given by its name or its number; None is the scene at
        rest.

        Before its first key frame and after its last one it stands still. What does not move, meshes and tuples
        included, is the same object as in this scene, so that renderers keep what they have of it. A scene without
        animations is returned as it is.

        Raises UsageError if there is no such animation, and InputError if it takes something where nothing can be
        drawn.
        """
        from .pose import posed

        expect(time, Real, "time", "a number of seconds")
        if not math.isfinite(time):
            raise UsageError(f"time={time}: not a number of seconds")
        if self.rig is None and animation in (0, None):
            return self
        return posed(self, self.animation(animation) if animation is not None else Animation("rest", ()), time)

    def animation(self, key: str | int) -> Animation:
        """The animation of this name or number. Raises UsageError if there is none."""
        if isinstance(key, Integral) and not isinstance(key, bool) and 0 <= key < len(self.animations):
            return self.animations[int(key)]
        found = next((animation for animation in self.animations if animation.name == key), None)
        if found is None:
            names = ", ".join(animation.name for animation in self.animations)
            raise UsageError(f"there is no animation {key!r}; " + (f"there are {names}" if names else "there are none"))
        return found

    def with_variant(self, name: str) -> Scene:
        """The scene in the materials of a variant, "" for the file's own choice, as they are at rest. All but the
        materials is the same object as in this scene. Raises UsageError if there is no such variant."""
        if name == self.variant:
            return self
        found = next((variant for variant in self.variants if variant.name == name), None)
        if found is None:
            names = ", ".join(variant.name for variant in self.variants[1:])
            raise UsageError(f"there is no variant {name!r}; " + (f"there are {names}" if names else "the file has no "
                                                                                                     "variants"))
        copy = self.relit(materials=found.materials, variant=name)
        return copy if self.rig is None else replace(copy, rig=replace(self.rig, materials=found.numbers))

    def digest_parts(self) -> dict[str, object]:
        """The fields that pictures of the scene depend on, for `base.digest`."""
        others = ("name", "warnings", "facts", "animations", "rig", "variants", "variant")
        return {item.name: getattr(self, item.name) for item in fields(self) if item.name not in others}

    def has_surfaces_of(self, other: Scene) -> bool:
        """Whether it has the very meshes, materials, instances, volumes and curves of another scene, under other lights
        perhaps."""
        return all(getattr(self, name) is getattr(other, name) for name in ("meshes", "materials", "instances",
                   "volumes")) and all(a is b for a, b in zip_longest(self.curves, other.curves))

    @cached_property
    def layout(self) -> tuple[object, ...]:
        """What is drawn, without where it is: scenes that differ in vertices or transforms only are equal in it."""
        return (self.materials, tuple(i.mesh for i in self.instances), tuple(mesh.layout for mesh in self.meshes),
                tuple(volume.layout for volume in self.volumes), tuple(curves.layout for curves in self.curves))

    @cached_property
    def transforms(self) -> np.ndarray:
        """Those of the instances, (instances, 4, 4) float64."""
        return np.stack([instance.transform for instance in self.instances]) if self.instances else np.zeros((0, 4, 4))

    @property
    def triangle_count(self) -> int:
        return sum(self.meshes[i.mesh].triangle_count for i in self.instances)


def _box_corners(bounds: np.ndarray) -> np.ndarray:
    """The eight corners, (8, 3), of the box with `bounds` (2, 3)."""
    pick = np.array([[(k >> axis) & 1 for axis in range(3)] for k in range(8)])
    return bounds[pick, [0, 1, 2]]
