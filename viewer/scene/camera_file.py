"""Files of cameras: transforms.json, as instant-ngp and nerfstudio read and write it.

A frame has the pose of a camera, `transform_matrix`, from camera space to world space, row-major. The camera looks
along its own -Z with +Y up, as in OpenGL and here. The intrinsics stand in a frame or, for all frames, at the top:

    w, h                               the size of the picture, in pixels
    fl_x, fl_y                         focal lengths, in pixels; fl_y is fl_x where it is missing
    camera_angle_x, camera_angle_y     in place of these, the fields of view that they are for a centred picture
    cx, cy                             the principal point, in pixels from the upper left corner of the picture
    camera_model                       ORTHOPHOTO is an orthographic camera, whose fl_x are pixels per world unit

Sources: nerfstudio's "Data conventions"; the reader of instant-ngp (src/nerf_loader.cu).
"""

from __future__ import annotations

import math
import os
import re
import warnings
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from os import PathLike
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ..base.atomic import write_json
from ..base.expect import expect, expect_path, expect_size
from .camera import MAX_PIXEL_ASPECT, MAX_PRINCIPAL, Camera
from .files import read_file
from .gltf.element import Document, Element
from .json_text import parse_json
from .scene import MAX_EXTENT

_PERSPECTIVE = ("PINHOLE", "SIMPLE_PINHOLE", "OPENCV", "RADIAL", "SIMPLE_RADIAL")
_ORTHOGRAPHIC = "ORTHOPHOTO"
_DISTORTION = ("k1", "k2", "k3", "k4", "k5", "k6", "p1", "p2")
_FISHEYE = "is_fisheye"
_INTRINSICS = ("camera_model", _FISHEYE, "w", "h", "fl_x", "fl_y", "camera_angle_x", "camera_angle_y", "cx", "cy",
               *_DISTORTION)
_FILES = ("file_path", "depth_file_path")
_NOT_RIGID = 1e-2
"""How far the rotation of a pose may be off, in any element: files have it with few digits."""
_ROUNDING = 1e-9
_LABEL_BYTES = 100
"""File systems have names of at most 255 bytes, of which the model's name needs some, too."""
MAX_SIDE = 1 << 16
"""The largest width or height of a picture in pixels."""


@dataclass(frozen=True, eq=False)
class CameraFrame:
    """A camera with the `size` (width, height) of its picture in pixels, and the files of the picture and of its depth,
    as far as there are any. The camera's name is that of the picture, or a number: no other frame of a file has it."""

    camera: Camera
    size: tuple[int, int]
    file: Path | None = None
    depth_file: Path | None = None

    def __post_init__(self) -> None:
        expect(self.camera, Camera, "CameraFrame.camera", "a Camera")
        object.__setattr__(self, "size", expect_size(self.size, "CameraFrame.size"))
        for name in ("file", "depth_file"):
            if getattr(self, name) is not None:
                expect_path(getattr(self, name), f"CameraFrame.{name}")
                object.__setattr__(self, name, Path(getattr(self, name)))


def read_camera_file(path: str | PathLike[str],
                     size: tuple[int, int]) -> tuple[tuple[CameraFrame, ...], tuple[str, ...]]:
    """The frames of a transforms.json, and lines for the user about what is not drawn as the file says.

    `size` (width, height) is that of pictures where the file does not say it. Raises InputError for a file that cannot
    be read, that has no frames, or a frame that no camera follows from.
    """
    path = Path(path)
    top = Element(Document(path), parse_json(path, read_file(path), takes_nan=True))  # errors name the place of one
    if "frames" not in top:
        raise top.error("is missing: there are no cameras", "frames")
    elements = top.array("frames")
    if not elements:
        raise top.error("is empty: there are no cameras", "frames")
    names = [_label(element.string("file_path", "")) for element in elements]
    often = Counter(map(str.casefold, names))  # some file systems take "a" and "A" for one name
    shared = {key: top.value[key] for key in _INTRINSICS if key in top.value}
    of_all: _Lens | None = None  # of frames without intrinsics of their own
    frames: list[CameraFrame] = []
    distorted: list[str] = []
    for k, (element, pose) in enumerate(zip(elements, _poses(elements), strict=True)):
        name = names[k] if names[k] and often[names[k].casefold()] == 1 else f"{k:0{len(str(len(elements) - 1))}}"
        if of_all is None or not element.value.keys().isdisjoint(_INTRINSICS):
            lens = _lens(Element(top.document, shared | element.value, element.place), size)
            distorted += lens.distorted
        else:
            lens = of_all
        if element.value.keys().isdisjoint(_INTRINSICS):
            of_all = lens
        frames.append(CameraFrame(Camera(pose, name=name, **lens.camera), lens.size, *_files(element)))
    if len({frame.camera.name for frame in frames}) < len(frames):  # a picture's name may be another's number
        frames = [replace(frame, camera=replace(frame.camera, name=f"{k:0{len(str(len(frames) - 1))}}"))
                  for k, frame in enumerate(frames)]
    if not distorted:
        return tuple(frames), ()
    keys = ", ".join(dict.fromkeys(distorted))
    return tuple(frames), (f"{path}: {keys}: the distortion of lenses is not drawn; pictures are those of ideal ones",)


def _label(file_path: str) -> str:
    """The name of a picture, as it can be part of a file's name on any system."""
    name = file_path.replace("\\", "/").rpartition("/")[2]
    stem = re.sub(r"\.(png|jpe?g|exr|webp|tiff?|bmp|hdr)$", "", name, flags=re.IGNORECASE)
    short = re.sub(r"[^\w.\-]+", "_", stem).encode()[:_LABEL_BYTES]
    return short.decode(errors="ignore").strip("._")


class _Lens(NamedTuple):
    """The intrinsics of a frame: arguments of `Camera`, (width, height) in pixels, and the keys that distort."""

    camera: dict[str, Any]
    size: tuple[int, int]
    distorted: list[str]


def _lens(element: Element, size: tuple[int, int]) -> _Lens:
    model = element.string("camera_model", "OPENCV")
    if model not in (*_PERSPECTIVE, _ORTHOGRAPHIC):
        raise element.error(f"{model[:40]!r} is not drawn, only {', '.join((*_PERSPECTIVE, _ORTHOGRAPHIC))}",
                            "camera_model")
    if element.value.get(_FISHEYE):
        raise element.error("fisheye lenses are not drawn", _FISHEYE)
    has_size = "w" in element and "h" in element
    if has_size:
        size = _side(element, "w"), _side(element, "h")
    width, height = size
    if "fl_x" in element:
        if not has_size:
            raise element.error("is in pixels of a picture of w x h, and w or h is missing", "fl_x")
        fx = _positive(element, "fl_x")
        fy = _positive(element, "fl_y") if "fl_y" in element else fx
    elif model == _ORTHOGRAPHIC:
        raise element.error("is missing", "fl_x")
    elif "camera_angle_x" in element:
        fx = _focal_length(element, "camera_angle_x", width)
        fy = _focal_length(element, "camera_angle_y", height) if "camera_angle_y" in element else fx
    else:
        raise element.error("neither fl_x nor camera_angle_x is there: the field of view is not known")
    principal = _principal(element, "cx", width), _principal(element, "cy", height)
    is_flat = model == _ORTHOGRAPHIC
    seen = height / fy if is_flat else 2 * math.atan(height / (2 * fy))
    if not (0 < seen < (math.inf if is_flat else math.pi) and 1 / MAX_PIXEL_ASPECT <= fy / fx <= MAX_PIXEL_ASPECT):
        raise element.error(f"no picture of {width}x{height} has focal lengths of {fx:g} and {fy:g} pixels")
    camera = {"principal": principal, "pixel_aspect": fy / fx, "height" if is_flat else "fov_y": seen}
    return _Lens(camera, size, [key for key in _DISTORTION if element.number(key, 0.0)])


def _files(element: Element) -> Iterator[Path | None]:
    """Of the picture and of its depth."""
    folder = element.document.path.parent
    for key in _FILES:
        file = element.string(key, "")
        yield folder / file if file else None


def _side(element: Element, key: str) -> int:
    side = element.integer(key, low=1)
    if side > MAX_SIDE:
        raise element.error(f"{side} pixels are more than {MAX_SIDE}", key)
    return side


def _principal(element: Element, key: str, side: int) -> float:
    principal = element.number(key, side / 2) / side
    if abs(principal) > MAX_PRINCIPAL:
        raise element.error(f"{principal * side:g} is more than {MAX_PRINCIPAL:g} pictures away", key)
    return principal


def _positive(element: Element, key: str) -> float:
    value = element.number(key)
    if not value > 0:
        raise element.error(f"{value:g} is not above 0", key)
    return value


def _focal_length(element: Element, key: str, side: int) -> float:
    angle = _positive(element, key)
    if angle >= math.pi:
        raise element.error(f"{angle:g} is not below pi; it is in radians", key)
    return side / (2 * math.tan(angle / 2) or math.ulp(0.0))


def _poses(elements: Sequence[Element]) -> np.ndarray:
    """The poses of frames, (N, 4, 4). A scale of a camera, which no picture shows, is dropped."""
    key = "transform_matrix"
    poses = np.array([_matrix(element, key) for element in elements], np.float64)

    def check(is_wrong: np.ndarray, problem: Callable[[int], str], place: str = key) -> None:
        for k in np.flatnonzero(is_wrong)[:1]:
            raise elements[k].error(problem(k), place)

    is_odd = (poses[:, 3] != (0, 0, 0, 1)).any(axis=1)
    check(is_odd, lambda k: f"is {poses[k, 3].tolist()}, not 0, 0, 0, 1", f"{key}[3]")
    linear = poses[:, :3, :3]
    left, scales, right = np.linalg.svd(linear)
    check(~(scales[:, 2] > 1e-6 * scales[:, 0]), lambda k: "is singular: a camera is turned and moved, not flattened")
    check(np.linalg.det(linear) < 0, lambda k: "mirrors (its determinant is negative): a camera is turned and moved")
    rotations, scale = left @ right, scales.mean(axis=1)  # the nearest rotations
    off = np.abs(linear / scale[:, None, None] - rotations).max(axis=(1, 2))
    check(off > _NOT_RIGID, lambda k: f"is no rotation with a translation: it is {off[k]:.2g} off")
    is_rounded = (off > _ROUNDING) | (np.abs(scale - 1) > _ROUNDING)
    poses[is_rounded, :3, :3] = rotations[is_rounded]
    return poses


def _matrix(element: Element, key: str) -> list[list[float]]:
    """Four rows of four numbers."""
    rows = element.value.get(key)
    if rows is None:
        raise element.error("is missing", key)
    if not isinstance(rows, list) or len(rows) != 4 or any(not isinstance(r, list) or len(r) != 4 for r in rows):
        raise element.error("must be four rows of four numbers", key)
    for k, row in enumerate(rows):
        for j, value in enumerate(row):
            if isinstance(value, bool) or not isinstance(value, (int, float)) or not abs(value) < MAX_EXTENT:
                raise element.error(f"must be a number below {MAX_EXTENT:g}", f"{key}[{k}][{j}]")
    return rows


def read_cameras(path: str | PathLike[str], size: tuple[int, int] = (1280, 720)) -> tuple[CameraFrame, ...]:
    """The cameras of a transforms.json, as nerfstudio and instant-ngp have it, with sizes and files of their pictures.

    `size` (width, height) is used for pictures whose size the file does not give. A UserWarning says that lens
    distortion is not drawn. Raises InputError for a file that cannot be read, or has no frames or invalid ones.
    """
    expect_path(path, "path")
    frames, lines = read_camera_file(path, expect_size(size, "size"))
    for line in lines:
        warnings.warn(line, stacklevel=2)
    return frames


def write_cameras(path: str | PathLike[str], frames: Sequence[CameraFrame]) -> None:
    """Write a transforms.json, which `read_cameras` reads as the same cameras, whole or not at all. The files of the
    pictures are named relative to its folder. Raises OutputError."""
    expect_path(path, "path")
    expect(frames, (tuple, list), "frames", "a list of CameraFrames")
    for k, frame in enumerate(frames):
        expect(frame, CameraFrame, f"frames[{k}]", "a CameraFrame")
    write_frames(path, [(camera_facts(frame.camera, frame.size), frame.file, frame.depth_file) for frame in frames])


def write_frames(path: str | PathLike[str], frames: Sequence[tuple[dict[str, Any], Path | None, Path | None]],
                 applied_transform: np.ndarray | None = None) -> None:
    """Write a transforms.json of `camera_facts`, each with the files of the picture and its depth, whole or not at all.

    Intrinsics that all share stand at the top. `applied_transform` (4, 4) takes the coordinates of the model's file to
    the world of the cameras, if that is another one. Raises OutputError.
    """
    folder = Path(path).absolute().parent
    first = frames[0][0] if frames else {}
    top: dict[str, Any] = {key: value for key, value in first.items()
                           if key in _INTRINSICS and all(facts.get(key) == value for facts, *_ in frames)}
    listed = []
    for facts, *files in frames:
        named = {key: _relative(file, folder) for key, file in zip(_FILES, files) if file is not None}
        listed.append(named | {key: value for key, value in facts.items() if key not in top})
    if applied_transform is not None:
        top["applied_transform"] = applied_transform[:3].tolist()
    write_json(path, top | {"frames": listed})


def _relative(file: Path, folder: Path) -> str:
    try:
        return Path(os.path.relpath(file.absolute(), folder)).as_posix()
    except ValueError:  # on another drive of Windows
        return file.absolute().as_posix()


def camera_facts(camera: Camera, size: tuple[int, int]) -> dict[str, Any]:
    """A frame without its files, with all intrinsics, in types that JSON can store.

    `read_camera_file` makes this very camera of the numbers, as far as there are numbers that it can make it of."""
    (width, height), (fx, fy, cx, cy) = size, camera.intrinsics(size)
    if camera.height is None:
        fy = _shortest(fy, lambda y: 2 * math.atan(height / (2 * y)), camera.fov_y)
        kind: dict[str, Any] = {"camera_model": "PINHOLE"}
    else:
        fy = _shortest(fy, lambda y: height / y, camera.height)
        kind = {"camera_model": _ORTHOGRAPHIC}
    fx = _shortest(fx, lambda x: fy / x, camera.pixel_aspect)
    if camera.height is None:  # for readers that know nothing else
        kind["camera_angle_x"] = 2 * math.atan(width / (2 * fx))
    return kind | {"w": width, "h": height, "fl_x": fx, "fl_y": fy,
                   "cx": _shortest(cx, lambda x: x / width, camera.principal[0]),
                   "cy": _shortest(cy, lambda y: y / height, camera.principal[1]),
                   "transform_matrix": camera.pose.tolist()}


def _shortest(value: float, read: Callable[[float], float], wanted: float) -> float:
    """Of the numbers beside `value` that are read as `wanted` the one with the fewest digits; `value` if none is.

    So what comes from a file is written as it stood there, although an angle was made of it."""
    step = math.ulp(value)
    exact = [near for near in (value + k * step for k in range(-8, 9)) if near and read(near) == wanted]
    return min(exact, key=lambda near: len(repr(near)), default=value)
