"""Traces rays with Embree's round linear curves.

embreex has no curves. So we call the Embree that it brings along, in packets of 16 rays, by Embree's own C interface.
Several threads do so at once, since Python lets others run while Embree traces. Each takes rays that begin near each
other, so that what Embree reads of the tree for one is in the cache for the next. No other Python binding has curves.
Where the library cannot be found, `EmbreeCurves` raises ImportError, and the BVH in a shader traces everything.

Embree may be built so that it reports where rays leave a curve, too. Such hits are passed.

Embree misses a segment of one radius where the ray is parallel to it, to within about 0.03 degrees. Such a ray enters
the strand by its end, so that the ends of strands are spheres of their own as well.
"""

from __future__ import annotations

import ctypes
import weakref
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

import embreex
import numpy as np
from numpy.typing import NDArray

from .threads import in_threads

if TYPE_CHECKING:
    from ..scene.curves import TraceCurves

_LIBRARIES = "../embreex.libs/*embree4*", ".dylibs/*embree4*"
"""Where wheels have the library, from the package: those for Linux and Windows, and those for macOS."""

_WIDTH = 16
_WORDS = 21
"""The words of RTCRayHit16 for each ray: 12 of the ray (origin, near, direction, time, far, mask, number, flags), then
the normal, u, v, and the numbers of primitive, geometry, instance and of the primitive of instances."""
_ORIGIN, _NEAR, _DIRECTION, _FAR, _MASK, _NORMAL, _PRIMITIVE, _GEOMETRY = 0, 3, 4, 8, 9, 12, 17, 18

_ROUND_LINEAR_CURVE, _SPHERE_POINT = 16, 50
_INDEX, _VERTEX, _FLAGS = 0, 1, 32  # RTCBufferType
_UCHAR, _UINT, _FLOAT4 = 0x1001, 0x5001, 0x9004  # RTCFormat
_LEFT, _RIGHT = 1, 2  # RTCCurveFlags: the segment has a neighbour there
_ROBUST = 1 << 2  # RTCSceneFlags

_EVEN = 2e-3
"""The slope of a segment's radius up to which Embree may miss it."""
_STEP = 1e-6
"""Step behind the back of a curve, in tracer units."""
_TASK = 1024
"""Rays that a thread traces before it takes others: some milliseconds."""
_SPREAD = np.array([sum((k >> bit & 1) << 3 * bit for bit in range(5)) for k in range(32)], np.uint16)
"""Numbers of five bits with two zeros after each."""
_MAX_BACKS = 256
"""A ray that has left so many curves hits nothing."""


@cache
def embree_with_curves() -> tuple[ctypes.CDLL, int]:
    """The library, and a device of it that stays."""
    package = Path(embreex.__file__).parent
    found = [path for pattern in _LIBRARIES for path in sorted(package.glob(pattern))]
    if not found:
        raise ImportError("embreex brings no library of Embree 4 along")
    try:
        library = ctypes.CDLL(str(found[0]))
        for name, result, arguments in (
            ("rtcNewDevice", _POINTER, [ctypes.c_char_p]),
            ("rtcNewScene", _POINTER, [_POINTER]),
            ("rtcSetSceneFlags", None, [_POINTER, ctypes.c_int]),
            ("rtcNewGeometry", _POINTER, [_POINTER, ctypes.c_int]),
            ("rtcSetSharedGeometryBuffer", None, [_POINTER, ctypes.c_int, ctypes.c_uint, ctypes.c_int, _POINTER,
                                                  ctypes.c_size_t, ctypes.c_size_t, ctypes.c_size_t]),
            ("rtcCommitGeometry", None, [_POINTER]),
            ("rtcAttachGeometry", ctypes.c_uint, [_POINTER, _POINTER]),
            ("rtcReleaseGeometry", None, [_POINTER]),
            ("rtcCommitScene", None, [_POINTER]),
            ("rtcReleaseScene", None, [_POINTER]),
            ("rtcGetDeviceError", ctypes.c_int, [_POINTER]),
            ("rtcIntersect16", None, [_POINTER] * 4),
        ):
            function = getattr(library, name)
            function.restype, function.argtypes = result, arguments
    except (OSError, AttributeError) as error:
        raise ImportError(f"the Embree that embreex brings along has no curves: {error}") from error
    device = library.rtcNewDevice(b"")
    if not device:
        raise ImportError("the Embree that embreex brings along makes no device")
    return library, device


_POINTER = ctypes.c_void_p


class EmbreeCurves:
    """The curves of a scene in Embree. Raises ImportError if Embree cannot be used for them."""

    def __init__(self, curves: TraceCurves) -> None:
        self.curves = curves
        self._library, device = embree_with_curves()
        rows = curves.first.astype(np.int64)
        has_left, has_right = curves.points[rows - 1, 3] >= 0, curves.points[rows + 2, 3] >= 0
        flags = (_LEFT * has_left | _RIGHT * has_right).astype(np.uint8)
        points, first = _with_length(curves.points, rows)
        flags[first != curves.first] = 0
        self._buffers = points, first, flags  # Embree reads these arrays as long as the scene lives.
        self._scene = self._library.rtcNewScene(device)
        weakref.finalize(self, self._library.rtcReleaseScene, self._scene)
        self._library.rtcSetSceneFlags(self._scene, _ROBUST)
        self._attach(device, _ROUND_LINEAR_CURVE, *zip((_VERTEX, _INDEX, _FLAGS), (_FLOAT4, _UINT, _UCHAR),
                                                       self._buffers, strict=True))
        self._ends = _ends(curves, has_left, has_right)
        if len(self._ends.segment):
            self._attach(device, _SPHERE_POINT, (_VERTEX, _FLOAT4, self._ends.spheres))
        self._library.rtcCommitScene(self._scene)
        if self._library.rtcGetDeviceError(device):
            raise ImportError("the Embree that embreex brings along cannot build a tree over curves")
        self._valid = _aligned((_WIDTH,), np.int32)
        self._valid[:] = -1

    def _attach(self, device: int, kind: int, *buffers: tuple[int, int, NDArray]) -> None:
        """Add a geometry with these buffers: what each holds, its format and its values."""
        geometry = self._library.rtcNewGeometry(device, kind)
        for what, form, values in buffers:
            self._library.rtcSetSharedGeometryBuffer(geometry, what, 0, form, values.ctypes.data, 0, values.strides[0],
                                                     len(values))
        self._library.rtcCommitGeometry(geometry)
        self._library.rtcAttachGeometry(self._scene, geometry)
        self._library.rtcReleaseGeometry(geometry)

    def intersect(
        self, origins: NDArray[np.float32], directions: NDArray[np.float32], reach: NDArray[np.float32] | float
    ) -> tuple[NDArray[np.int64], NDArray[np.float32]]:
        """The number of the segment that each ray enters first within `reach`, -1 for none, and the t there, (N,) each.

        Origins and directions are (N, 3).
        """
        segment, far = np.empty(len(origins), np.int64), np.empty(len(origins), np.float32)
        far[:] = reach
        order = _along_curve(origins)

        def trace(begin: int) -> None:
            rays = order[begin:begin + _TASK]
            segment[rays], far[rays] = self._entered(origins[rays], directions[rays], far[rays])

        in_threads(trace, range(0, len(order), _TASK))
        return segment, far

    def _entered(self, origins: NDArray, directions: NDArray, far: NDArray
                 ) -> tuple[NDArray[np.int64], NDArray[np.float32]]:
        """As `intersect`, of a few rays that are to be traced one after the other."""
        count = len(origins)
        segment = np.full(count, -1, np.int64)
        near, pending = np.zeros(count, np.float32), np.arange(count)
        for _ in range(_MAX_BACKS):
            if not len(pending):
                break
            found, t, normal, is_end = self._first(origins[pending], directions[pending], near[pending], far[pending])
            is_hit = found >= 0
            is_back = is_hit & (np.einsum("ij,ij->i", normal, directions[pending]) > 0)
            end = found[is_end]
            is_back[is_end] |= np.einsum("ij,ij->i", normal[is_end], self._ends.outwards[end]) < 0  # within the strand
            found[is_end] = self._ends.segment[end]
            entered = is_hit & ~is_back
            segment[pending[entered]], far[pending[entered]] = found[entered], t[entered]
            step = _STEP / np.linalg.norm(directions[pending[is_back]], axis=1)
            pending, t = pending[is_back], t[is_back]
            near[pending] = t + np.maximum(step, 1e-6 * t)
        return segment, far

    def overwrite(self, hits: NDArray[np.uint32], texels: NDArray[np.intp], origins: NDArray[np.float32],
                  directions: NDArray[np.float32], reach: NDArray[np.float32]) -> None:
        """Write the hits within `reach` (N,) of rays (N, 3) to rows `texels` (N,) of `hits`, and lower `reach` to them.
        """
        segment, far = self.intersect(origins, directions, reach)
        (found,) = np.nonzero(segment >= 0)
        reach[found] = far[found]
        rows = texels[found]
        hits[rows, 0], hits[rows, 1] = self.curves.codes[segment[found]], self.curves.first[segment[found]]
        hits[rows, 2:] = 0

    def _first(self, origins: NDArray, directions: NDArray, near: NDArray, far: NDArray
               ) -> tuple[NDArray[np.int32], NDArray[np.float32], NDArray[np.float32], NDArray[np.bool_]]:
        """What Embree finds first: segments (N,), t (N,), normals (N, 3), and whether it is the end of a strand, whose
        number then stands for the segment's, (N,)."""
        count = len(origins)
        packets = -(-count // _WIDTH)
        words = _aligned((packets, _WORDS, _WIDTH), np.float32)
        bits = words.view(np.uint32)
        words[-1] = 0
        words[-1, _FAR] = -1  # a ray that is none
        _put(words, _ORIGIN, origins)
        _put(words, _DIRECTION, directions)
        _put(words, _NEAR, near[:, None])
        _put(words, _FAR, far[:, None])
        words[:, _DIRECTION + 3] = 0  # the time
        bits[:, _MASK] = 0xFFFFFFFF
        bits[:, _MASK + 1:_NORMAL] = 0
        bits[:, _PRIMITIVE:] = 0xFFFFFFFF
        self._trace(words)
        t, normal = _take(words, _FAR, 1, count)[:, 0], _take(words, _NORMAL, 3, count)
        found = _take(bits, _PRIMITIVE, 1, count)[:, 0].view(np.int32)
        return found, t, normal, (_take(bits, _GEOMETRY, 1, count)[:, 0] == 1) & (found >= 0)

    def _trace(self, words: NDArray[np.float32]) -> None:
        """Trace packets (N, _WORDS, _WIDTH), and write to them what Embree finds."""
        intersect, valid, scene = self._library.rtcIntersect16, self._valid.ctypes.data, self._scene
        begin, size = words.ctypes.data, words[0].nbytes
        for packet in range(begin, begin + len(words) * size, size):
            intersect(valid, scene, packet, None)


def _along_curve(origins: NDArray[np.float32]) -> NDArray[np.intp]:
    """The order of points (N, 3) along a Morton curve through 32 x 32 x 32 cells about the scene, (N,)."""
    x, y, z = _SPREAD[np.fmin(np.fmax(16 * origins + 16, 0), 31).astype(np.uint8)].T
    return np.argsort(x | y << 1 | z << 2, kind="stable")


@dataclass(frozen=True, eq=False)
class _Ends:
    """Ends of strands: spheres (n, 4) float32, the segment of each (n,) and the direction out of it (n, 3)."""

    spheres: NDArray[np.float32]
    segment: NDArray[np.int64]
    outwards: NDArray[np.float32]


def _ends(curves: TraceCurves, has_left: NDArray[np.bool_], has_right: NDArray[np.bool_]) -> _Ends:
    """The ends of segments that Embree may miss."""
    (left,), (right,) = np.nonzero(~has_left), np.nonzero(~has_right)
    segment, is_right = np.concatenate([left, right]), np.repeat([0, 1], [len(left), len(right)])
    first = curves.first[segment].astype(np.int64)
    way = curves.points[first + 1] - curves.points[first]
    is_even = np.abs(way[:, 3]) <= _EVEN * np.linalg.norm(way[:, :3], axis=1)
    outwards = np.where(is_right[:, None], way[:, :3], -way[:, :3])
    return _Ends(curves.points[first + is_right][is_even], segment[is_even], outwards[is_even])


def _with_length(points: NDArray[np.float32], rows: NDArray[np.int64]
                 ) -> tuple[NDArray[np.float32], NDArray[np.uint32]]:
    """The points, and the row of each segment's first. Embree shows no segment without length, which is a sphere: such
    segments have points of their own, a thousandth of the radius apart."""
    is_same = points[1:, :3] == points[:-1, :3]
    (short,) = np.nonzero((is_same[:, 0] & is_same[:, 1] & is_same[:, 2])[rows])
    if not len(short):
        return np.ascontiguousarray(points), rows.astype(np.uint32)
    spheres = np.repeat(points[rows[short]], 2, axis=0)
    spheres[:, 3] = np.repeat(np.maximum(points[rows[short], 3], points[rows[short] + 1, 3]), 2)
    spheres[1::2, 0] += np.maximum(spheres[1::2, 3] / 1024, np.spacing(np.abs(spheres[1::2, 0])))
    rows = rows.copy()
    rows[short] = len(points) + 2 * np.arange(len(short))
    return np.concatenate([points, spheres]), rows.astype(np.uint32)


def _aligned(shape: tuple[int, ...], dtype: type) -> NDArray:
    """An array that begins at a multiple of 64 bytes, as packets have to; it is not set to anything."""
    size = int(np.prod(shape)) * np.dtype(dtype).itemsize
    memory = np.empty(size + 64, np.uint8)
    start = -memory.ctypes.data % 64
    return memory[start:start + size].view(dtype).reshape(shape)


def _put(words: NDArray, place: int, values: NDArray) -> None:
    """Write (N, k) values to the words from `place` on."""
    count, width = values.shape
    whole = count // _WIDTH
    words[:whole, place:place + width] = values[:whole * _WIDTH].reshape(whole, _WIDTH, width).transpose(0, 2, 1)
    if count > whole * _WIDTH:
        words[-1, place:place + width, :count - whole * _WIDTH] = values[whole * _WIDTH:].T


def _take(words: NDArray, place: int, width: int, count: int) -> NDArray:
    """The words from `place` on as (count, width)."""
    return words[:, place:place + width].transpose(0, 2, 1).reshape(-1, width)[:count]
