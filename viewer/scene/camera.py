"""Cameras. Vectors are columns, spaces are right-handed, numbers are float64; a camera looks along its own -Z."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from numbers import Real

import numpy as np
from numpy.typing import ArrayLike

from ..base.expect import expect, expect_number, expect_positive
from ..errors import UsageError
from .arrays import HoldsArrays, scene_array, scene_numbers

DEFAULT_FOV = math.radians(45.0)
DEFAULT_AZIMUTH = math.radians(30.0)
DEFAULT_ELEVATION = math.radians(15.0)
MAX_PRINCIPAL = 1e3
"""The farthest that the principal point may lie outside, in pictures: float32 then still tells pixels apart."""
MAX_PIXEL_ASPECT = 1e3
_NOT_RIGID = 1e-2
"""How far the columns of a rotation may be from orthonormal: poses are written with few digits."""


@dataclass(frozen=True, eq=False)
class Camera(HoldsArrays):
    """A rigid pose and a projection.

    `pose` (4, 4) float64 takes camera space to world space and contains only rotation and translation, for columns: the
    eye is `pose[:3, 3]`. A pose that mirrors, scales or is transposed raises UsageError. `fov_y` is the
    vertical field of view in radians. If `height` is given, the camera is orthographic and shows `height` world units
    from bottom to top. `near`, in world units, is the nearest distance that has to be visible. It is used only if
    OpenGL cannot reverse depth (viewer/raster/depth.py): surfaces closer than `near` are then clipped, so that distant
    ones can be distinguished.

    `principal` is the principal point, where the view axis crosses the picture, in widths from its left side and
    heights from its top; it may lie outside of the picture. `pixel_aspect` is the width of a pixel over its height.
    `fov_y` is then the field of view of a picture of the same height with the principal point at its centre. None of
    these depends on the size of the picture; `from_intrinsics` and `intrinsics` convert from and to focal lengths in
    pixels.
    """

    pose: np.ndarray
    fov_y: float = DEFAULT_FOV
    height: float | None = None
    name: str = ""
    near: float | None = None
    principal: tuple[float, float] = (0.5, 0.5)
    pixel_aspect: float = 1.0

    def __post_init__(self) -> None:
        self._set("pose", scene_array(self.pose, "Camera.pose", np.float64, 4, 4))
        _check_rigid(self.pose)
        expect(self.name, str, "Camera.name", "text")
        for key in ("fov_y", "height", "near", "pixel_aspect"):
            value = getattr(self, key)
            if value is not None or key in ("fov_y", "pixel_aspect"):
                expect(value, Real, f"Camera.{key}", "a number")
                self._set(key, float(value))  # of numpy's float32, too, which JSON cannot store
        if self.height is None:
            check_fov(self.fov_y, "Camera.fov_y")
        for key in ("height", "near"):
            if getattr(self, key) is not None:
                expect_positive(getattr(self, key), f"Camera.{key}")
        self._set("principal", scene_numbers(self.principal, "Camera.principal", 2))
        if max(map(abs, self.principal)) > MAX_PRINCIPAL:
            raise UsageError(f"Camera.principal is {self.principal}: it is more than {MAX_PRINCIPAL:g} pictures away")
        if not 1 / MAX_PIXEL_ASPECT <= self.pixel_aspect <= MAX_PIXEL_ASPECT:
            raise UsageError(f"Camera.pixel_aspect is {self.pixel_aspect:g}, not from {1 / MAX_PIXEL_ASPECT:g} to "
                             f"{MAX_PIXEL_ASPECT:g}")

    @property
    def eye(self) -> np.ndarray:
        return self.pose[:3, 3]

    @property
    def forward(self) -> np.ndarray:
        return -self.pose[:3, 2]

    @property
    def key(self) -> tuple[object, ...]:
        """What pictures depend on: equal for cameras whose pictures are equal."""
        return self.pose.tobytes(), self.fov_y, self.height, self.near, self.principal, self.pixel_aspect

    def window(self, aspect: float) -> tuple[np.ndarray, np.ndarray]:
        """Half the size of what is seen, and where its middle is from the view axis, (2,) float64 each, to the right
        and upwards. It is measured at depth 1; of an orthographic camera it is in world units.

        `aspect` is width / height of the picture in pixels.
        """
        half_height = math.tan(self.fov_y / 2) if self.height is None else self.height / 2
        half = np.array([half_height * (aspect * self.pixel_aspect), half_height])
        return half, half * (1 - 2 * self.principal[0], 2 * self.principal[1] - 1)

    @classmethod
    def from_intrinsics(cls, pose: ArrayLike, fx: float, fy: float, cx: float, cy: float, size: tuple[int, int],
                        name: str = "") -> Camera:
        """A calibrated perspective camera: focal lengths `fx`, `fy` and the principal point `cx`,
        `cy`, in pixels of a picture of `size` (width, height).

        (0, 0) is the corner of the upper left pixel; the middle of the picture is at (width / 2, height / 2). `pose`
        (4, 4) takes camera space to world space; the camera looks along its own -Z with +Y up, as in OpenGL. Poses
        of OpenCV and COLMAP look along +Z with +Y down: their second and third columns are to be negated.
        """
        fx, fy, cx, cy = scene_numbers((fx, fy, cx, cy), "fx, fy, cx, cy", 4)
        width, height = _size(size)
        if min(fx, fy) <= 0:
            raise UsageError(f"fx={fx:g}, fy={fy:g}: a focal length is above 0")
        return cls(np.asarray(pose), 2 * math.atan(height / (2 * fy)), name=name,
                   principal=(cx / width, cy / height), pixel_aspect=fy / fx)

    def intrinsics(self, size: tuple[int, int]) -> tuple[float, float, float, float]:
        """fx, fy, cx, cy in pixels of a picture of `size` (width, height), as `from_intrinsics` takes them. The focal
        lengths of an orthographic camera are pixels per world unit."""
        width, height = _size(size)
        fy = height / (2 * math.tan(self.fov_y / 2)) if self.height is None else height / self.height
        return fy / self.pixel_aspect, fy, self.principal[0] * width, self.principal[1] * height

    def orthographic(self, depth: float) -> Camera:
        """This camera without perspective. At the distance `depth` from the eye it shows as much as before."""
        expect_positive(depth, "depth")
        return replace(self, height=2 * depth * math.tan(self.fov_y / 2))

    @classmethod
    def look_at(cls, eye: ArrayLike, target: ArrayLike, up: ArrayLike = (0.0, 1.0, 0.0), fov_y: float = DEFAULT_FOV,
                name: str = "") -> Camera:
        """A perspective camera at `eye` that looks at `target`. An `up` parallel to the view is replaced by an axis.

        Raises UsageError if `eye` is `target`.
        """
        eye, target, up = (scene_array(v, name, np.float64, 3) for v, name in (
            (eye, "eye"), (target, "target"), (up, "up")))
        if np.array_equal(eye, target):
            raise UsageError(f"eye and target are both {', '.join(f'{x:g}' for x in eye)}: there is no direction to "
                             "look in")
        return cls(pose_of(eye, eye - target, up), fov_y, name=name)

    @classmethod
    def orbit(cls, center: ArrayLike, distance: float, azimuth: float = DEFAULT_AZIMUTH,
              elevation: float = DEFAULT_ELEVATION, fov_y: float = DEFAULT_FOV) -> Camera:
        """A camera on a sphere about `center`. Azimuth 0 is at +Z and grows towards +X; elevation grows upwards. Both
        are in radians."""
        center = scene_array(center, "center", np.float64, 3)
        for name, value in (("distance", distance), ("azimuth", azimuth), ("elevation", elevation)):
            expect_number(value, name, is_finite=True)
        cos_el = math.cos(elevation)
        back = np.array([cos_el * math.sin(azimuth), math.sin(elevation), cos_el * math.cos(azimuth)])
        # The derivative of `back` with respect to elevation is a valid "up" even at the poles, where +Y is not.
        up = np.array([-math.sin(elevation) * math.sin(azimuth), cos_el, -math.sin(elevation) * math.cos(azimuth)])
        if distance == 0:
            raise UsageError("distance is 0: the camera would be at the centre that it looks at")
        return cls(pose_of(center + distance * back, distance * back, up), fov_y)

    @classmethod
    def framing(cls, center: ArrayLike, radius: float, aspect: float, azimuth: float = DEFAULT_AZIMUTH,
                elevation: float = DEFAULT_ELEVATION, fov_y: float = DEFAULT_FOV) -> Camera:
        """An orbit camera at the distance at which the sphere (center, radius) fills its narrower field of view.

        From every direction it is the same distance, and nothing is cut off, as a turntable needs.
        `Scene.framing_camera` is the one that the scene itself fills.
        """
        return cls.orbit(center, framing_distance(radius, aspect, fov_y), azimuth, elevation, fov_y)

    def view(self) -> np.ndarray:
        """World to camera, (4, 4) float64."""
        rotation = self.pose[:3, :3].T
        view = np.eye(4)
        view[:3, :3], view[:3, 3] = rotation, -rotation @ self.pose[:3, 3]
        return view

    def projection(self, aspect: float, near: float, far: float) -> np.ndarray:
        """Camera space to OpenGL clip space (z from -w at `near` to +w at `far`), (4, 4) float64."""
        expect_positive(aspect, "aspect")
        if not near < far:
            raise UsageError(f"near={near:g}, far={far:g}: near must be below far")
        out = np.zeros((4, 4))
        half, middle = self.window(aspect)
        if self.height is None:
            out[1, 1] = 1.0 / math.tan(self.fov_y / 2)
            out[2, 2], out[2, 3], out[3, 2] = (far + near) / (near - far), 2 * far * near / (near - far), -1.0
            out[:2, 2] = middle / half
        else:
            out[1, 1] = 2.0 / self.height
            out[2, 2], out[2, 3], out[3, 3] = 2.0 / (near - far), (far + near) / (near - far), 1.0
            out[:2, 3] = -middle / half
        out[0, 0] = out[1, 1] / (aspect * self.pixel_aspect)
        return out

    def depth_range(self, center: ArrayLike, radius: float) -> tuple[float, float]:
        """Near and far planes that enclose the sphere (center, radius), with the near plane as far away as possible."""
        depth = float((np.asarray(center, np.float64) - self.eye) @ self.forward)
        far = max(depth + radius, radius * 1e-3) * 1.001
        near = depth - radius
        if self.height is not None:
            return near - 1e-3 * radius, max(far, near + radius)
        return max(near * 0.999, far * 1e-5), far


def _check_rigid(pose: np.ndarray) -> None:
    """Raises UsageError for what is no rotation with a translation: views are inverted by transposing the rotation."""
    if pose[3].tolist() != [0, 0, 0, 1]:
        hint = "; the translation stands in the last column" if pose[:3, 3].tolist() == [0, 0, 0] else ""
        raise UsageError(f"Camera.pose[3] is {pose[3].tolist()}, not 0, 0, 0, 1{hint}")
    rotation = pose[:3, :3]
    with np.errstate(over="ignore", invalid="ignore"):
        off = float(np.abs(rotation.T @ rotation - np.eye(3)).max())
    if not off <= _NOT_RIGID:
        raise UsageError("Camera.pose is no rotation with a translation: its columns are not of length 1 and at right "
                         "angles")
    if np.linalg.det(rotation) < 0:
        raise UsageError("Camera.pose mirrors (its determinant is negative): a camera is turned and moved")


def pose_of(eye: np.ndarray, back: np.ndarray, up: np.ndarray) -> np.ndarray:
    """The pose of a camera at `eye` that looks along -`back`. Neither that nor `up` needs length 1."""
    back, up = (np.ldexp(v, -np.frexp(np.abs(v).max())[1]) for v in (back, up))  # so that no square overflows
    back = back / np.linalg.norm(back)
    right = np.cross(up, back)
    if np.linalg.norm(right) < 1e-9:
        right = np.cross([0.0, 0.0, -1.0] if abs(back[1]) > 0.5 else [0.0, 1.0, 0.0], back)
    pose = np.eye(4)
    pose[:3, 0] = right / np.linalg.norm(right)
    pose[:3, 1], pose[:3, 2], pose[:3, 3] = np.cross(back, pose[:3, 0]), back, eye
    return pose


def check_fov(fov_y: float, name: str) -> None:
    """Raises UsageError if it is no field of view of a perspective camera, in radians."""
    expect_number(fov_y, name)
    if not 0 < fov_y < math.pi:
        hint = "; it is in radians: math.radians(45), say" if fov_y >= math.pi else ""
        raise UsageError(f"{name} is {fov_y:g}, which is not between 0 and pi{hint}")


def _size(size: object) -> tuple[float, float]:
    width, height = scene_numbers(size, "size", 2)
    if min(width, height) <= 0:
        raise UsageError(f"size={size!r}: it must be (width, height) in pixels")
    return width, height


def framing_distance(radius: float, aspect: float, fov_y: float) -> float:
    """The distance from the eye to the centre of a sphere that fills the narrower field of view."""
    expect_positive(radius, "radius")
    expect_positive(aspect, "aspect")
    check_fov(fov_y, "fov_y")
    half = fov_y / 2 if aspect >= 1 else math.atan(math.tan(fov_y / 2) * aspect)
    return radius / math.sin(half)
