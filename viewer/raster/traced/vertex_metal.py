"""Metallic and roughness at vertices, which is precise enough for surfaces seen in reflections."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...material.fold import without_constant_maps
from ...scene.material import Material, Texture
from ...scene.mesh import Mesh


def vertex_metal(material: Material, mesh: Mesh) -> NDArray[np.float64]:
    """(V, 2) in [0, 1]: perceptual roughness and metallic. Raises InputError for an image that is broken."""
    material = without_constant_maps(material)
    factors = np.array([material.perceptual_roughness, material.metallic])
    texture = material.metallic_roughness_texture
    if texture is None or texture.uv_set >= len(mesh.uvs) or material.metallic == 0:
        return np.tile(factors, (len(mesh.positions), 1))
    return factors * _nearest(texture, mesh.uvs[texture.uv_set].astype(np.float64))


def _nearest(texture: Texture, uv: NDArray[np.float64]) -> NDArray[np.float64]:
    """The nearest texels' G and B, (V, 2); the image is taken to repeat."""
    if texture.transform is not None:
        matrix = texture.transform.matrix()
        uv = uv @ matrix[:, :2].T + matrix[:, 2]
    pixels = texture.image.decode("GB")
    height, width = pixels.shape[:2]
    uv = np.nan_to_num(uv - np.floor(uv))
    column = np.minimum((uv[:, 0] * width).astype(int), width - 1)
    row = np.minimum((uv[:, 1] * height).astype(int), height - 1)
    return pixels[row, column] / np.iinfo(pixels.dtype).max
