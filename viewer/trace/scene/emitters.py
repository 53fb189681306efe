"""Emissive triangles as lights: their records in the scene buffer and their powers."""

from __future__ import annotations

import numpy as np

from ...material.pack import COLOR_ROLES
from ...scene.color import LUMINANCE, srgb_to_linear
from ...scene.material import Texture
from ...scene.scene import Scene
from .geometry import TraceGeometry, TraceInstance
from .materials import TraceMaterial

_MAX_SIDE = 1024
"""Side of a summed-area table. The texels of a larger image are summed in blocks."""


def find_emitters(scene: Scene, geometry: TraceGeometry) -> tuple[np.ndarray, np.ndarray]:
    """Records (N, 4) uint32 and powers (N,) float64 of the emissive triangles, in the order of their numbers.

    A record has instance and triangle. The power is pi times the area in tracer units times the mean luminance, twice
    that for a double-sided material; it is 0 only where no texel emits. Raises InputError for a texture that cannot be
    decoded.
    """
    records = np.zeros((geometry.emitters, 4), np.uint32)
    powers = np.zeros(geometry.emitters)
    tables: dict[tuple[int, tuple[float, ...]], _MeanLuminance] = {}
    for number, instance in enumerate(geometry.instances):
        if instance.first_emitter < 0:
            continue
        count = len(geometry.meshes[instance.mesh].triangles)
        run = slice(instance.first_emitter, instance.first_emitter + count)
        records[run, 0], records[run, 1] = number, np.arange(count)
        material = geometry.materials[instance.material]
        emissive = material.material.emissive
        texture = _emission_map(material)
        if texture is None:
            luminance: float | np.ndarray = float(LUMINANCE @ emissive)
        else:
            key = id(texture.image), emissive
            if key not in tables:
                tables[key] = _MeanLuminance(texture, emissive)
            luminance = tables[key].of_triangles(texture, _texture_coordinates(scene, geometry, instance, texture))
        powers[run] = np.pi * _areas(geometry, instance) * luminance * (1 + material.material.double_sided)
    return records, powers


def _emission_map(material: TraceMaterial) -> Texture | None:
    return next((use.texture for use in material.color_maps if use.roles & COLOR_ROLES["emissive"]), None)


def _areas(geometry: TraceGeometry, instance: TraceInstance) -> np.ndarray:
    mesh = geometry.meshes[instance.mesh]
    corners = (mesh.positions @ instance.transform[:, :3].T)[mesh.triangles]
    return 0.5 * np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)


def _texture_coordinates(
    scene: Scene, geometry: TraceGeometry, instance: TraceInstance, texture: Texture
) -> np.ndarray:
    """Texture coordinates of the corners, (M, 3, 2), transformed as the texture says."""
    mesh = geometry.meshes[instance.mesh]
    uv = scene.meshes[mesh.source].uvs[texture.uv_set].astype(np.float64)
    if texture.transform is not None:
        matrix = texture.transform.matrix()
        uv = uv @ matrix[:, :2].T + matrix[:, 2]
    return uv[mesh.triangles]


class _MeanLuminance:
    """Mean luminance, over rectangles, of an image times a colour, by a summed-area table (Crow 1984)."""

    def __init__(self, texture: Texture, color: tuple[float, float, float]) -> None:
        pixels = texture.image.decode("RGB")
        linear = srgb_to_linear(np.arange(np.iinfo(pixels.dtype).max + 1) / np.iinfo(pixels.dtype).max)
        luminance = sum((linear * weight).astype(np.float32)[pixels[..., k]]
                        for k, weight in enumerate(LUMINANCE * color))
        self._height, self._width = luminance.shape
        self._side = max(-(-max(luminance.shape) // _MAX_SIDE), 1)
        blocks = np.add.reduceat(luminance, np.arange(0, self._height, self._side), axis=0, dtype=np.float64)
        blocks = np.add.reduceat(blocks, np.arange(0, self._width, self._side), axis=1)
        self._sums = np.pad(blocks.cumsum(axis=0).cumsum(axis=1), ((1, 0), (1, 0)))
        self._mean = self._sums[-1, -1] / luminance.size
        # Differences of sums may have rounding errors where all texels are 0; differences of counts have none.
        self._lit = np.pad((blocks > 0).cumsum(axis=0).cumsum(axis=1), ((1, 0), (1, 0)))

    def of_triangles(self, texture: Texture, uv: np.ndarray) -> np.ndarray:
        """Mean luminance of triangles, (M,): over the blocks that touch the triangle's box and a texel around it.

        If that box leaves the image, the mean of the whole image is taken.
        """
        size = np.array([self._width, self._height])
        low, high = uv.min(axis=1), uv.max(axis=1)
        if texture.sampler.wrap_s == texture.sampler.wrap_t == "repeat":
            low, high = low - np.floor(low), high - np.floor(low)
        is_inside = ((low * size >= 1) & (high * size <= size - 1)).all(axis=1)
        first = np.where(is_inside[:, None], low * size - 1, 0).astype(int) // self._side
        last = -(-np.where(is_inside[:, None], np.ceil(high * size) + 1, 1).astype(int) // self._side)
        texels = (np.minimum(last * self._side, size) - first * self._side).prod(axis=1)
        lit = _rectangle(self._lit, first, last)
        # Differences below this are rounding errors of the sums.
        mean = np.maximum(_rectangle(self._sums, first, last) / texels, 1e-3 * self._mean)
        return np.where(is_inside, np.where(lit > 0, mean, 0.0), self._mean)


def _rectangle(sums: np.ndarray, first: np.ndarray, last: np.ndarray) -> np.ndarray:
    (x0, y0), (x1, y1) = first.T, last.T
    return sums[y1, x1] - sums[y0, x1] - sums[y1, x0] + sums[y0, x0]
