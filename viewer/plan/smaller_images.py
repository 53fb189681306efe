"""Images no larger than a picture needs: the largest mip levels, which hardly a pixel would miss, are left out.

A pixel reads a texture at the level log2(rho), where rho is the longer of the two steps in texels to the pixels beside
it. Their product is at least the area that they span, so 4^level is at least the texels on a pixel's area. A triangle
of area A whose plane is at the distance h from the eye has f^2 h A / z^3 pixels at depth z, with the focal length f in
pixels. With the least z of its vertices this is an upper bound, and the texels that it covers are known.

What a pixel loses that reads level l where those below k are left out is 1 - 2^(l - k): by so much the contrast of
noise falls from level l to level k. A few that lose all of it are seen as well as many that lose little.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from ..scene.camera import Camera
from ..scene.material import Material
from ..scene.mesh import Mesh
from ..scene.scene import Scene
from ..scene.schema import MAPS
from ..scene.texture_image import TextureImage

MOST_HALVINGS = 3
"""What is left of an image is 1 / 64 of its texels then, so that more would save little."""
MAX_LOSS = 5e-4
"""The mean over all pixels of a picture of what they lose."""
MIN_TEXELS = 1 << 20
"""Of smaller images there is nothing to save."""
MAX_TRIANGLES = 200_000
"""Looking at more would take longer than it can save."""


class SmallerImages:
    """Gives scenes smaller images. Those of one scene are kept for its next picture, unless that needs larger ones."""

    def __init__(self) -> None:
        self._images: dict[TextureImage, TextureImage] = {}
        self._given: tuple[Material, ...] = ()
        self._taken: tuple[Material, ...] = ()

    def of(self, scene: Scene, camera: Camera, size: tuple[int, int]) -> Scene:
        """`scene` with the images that a picture of `size` points by `camera` needs."""
        images = {image: self._image(image, count) for image, count in halvings(scene, camera, size).items()}
        if scene.materials is not self._given or images != self._images:
            self._given, self._images = scene.materials, images
            self._taken = tuple(_with_images(material, images) for material in scene.materials)
        return scene.relit(materials=self._taken)

    def _image(self, image: TextureImage, count: int) -> TextureImage:
        kept = self._images.get(image)
        if kept is not None and kept.halvings <= count:
            return kept
        return image.smaller(count) if count else image


def halvings(scene: Scene, camera: Camera, size: tuple[int, int]) -> dict[TextureImage, int]:
    """How many of the largest levels of each image of `scene` its picture can do without; 0 where that is not known."""
    most = {image: _most(image) for image in scene.images}
    is_supersampled = bool(scene.curves) or any(material.weave is not None for material in scene.materials)
    if not any(most.values()) or scene.triangle_count > MAX_TRIANGLES or is_supersampled:
        return dict.fromkeys(most, 0)
    lost = {image: np.zeros(MOST_HALVINGS) for image in most}  # the sum over pixels, without levels below 1, 2 and 3
    for instance in scene.instances:
        mesh = scene.meshes[instance.mesh]
        material = scene.materials[mesh.material]
        textures = {name: texture for name, each in MAPS.items()
                    if (texture := each.texture(material)) is not None and most[texture.image]}
        pixels = _pixels(mesh, instance.transform, material.double_sided, camera, size) if textures else None
        areas = {use: _areas(mesh, use) for use in {texture.uv_set for texture in textures.values()}}
        for name, texture in textures.items():
            casts_shadows = name == "base_color" and material.alpha_mode != "opaque"
            area = areas[texture.uv_set]
            if pixels is None or area is None or casts_shadows or texture.sampler.mip_filter is None:
                lost[texture.image] += np.inf
                continue
            texels = area * (texture.image.width * texture.image.height)
            if texture.transform is not None:
                texels = texels * abs(texture.transform.scale[0] * texture.transform.scale[1])
            for k in range(most[texture.image]):
                lost[texture.image][k] += np.maximum(pixels - np.sqrt(texels * pixels) / 2.0 ** (k + 1), 0).sum()
    allowed = MAX_LOSS * size[0] * size[1]
    return {image: int((lost[image][:count] <= allowed).sum()) for image, count in most.items()}


def _most(image: TextureImage) -> int:
    """How often both sides can be halved without a rest, if it is worth while."""
    if image.width * image.height < MIN_TEXELS:
        return 0
    return next(count for count in range(MOST_HALVINGS, -1, -1) if not (image.width | image.height) % (1 << count))


def _pixels(mesh: Mesh, transform: np.ndarray, double_sided: bool, camera: Camera,
            size: tuple[int, int]) -> np.ndarray | None:
    """At most how many pixels each triangle covers, (T,); None for other meshes, and if one reaches behind the eye."""
    if mesh.topology != "triangles":
        return None
    points = mesh.positions @ transform[:3, :3].T + (transform[:3, 3] - camera.eye)
    corners = (points @ camera.pose[:3, :3])[_corners(mesh)]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) / 2
    half, _ = camera.window(size[0] / size[1])
    scale = size[0] * size[1] / (4 * half[0] * half[1])
    if camera.height is not None:
        facing = normals[:, 2] * scale
    else:
        depth = -corners[:, :, 2].max(axis=1)
        if (depth <= 0).any():
            return None
        facing = -(normals * corners[:, 0]).sum(axis=1) * scale / depth**3
    return np.abs(facing) if double_sided else np.maximum(facing * np.sign(np.linalg.det(transform[:3, :3])), 0)


def _areas(mesh: Mesh, uv_set: int) -> np.ndarray | None:
    """The area of each triangle in the texture, which is 1, (T,); None for other meshes, and those without the set."""
    if mesh.topology != "triangles" or uv_set >= len(mesh.uvs):
        return None
    corners = mesh.uvs[uv_set].astype(np.float64)[_corners(mesh)]
    one, two = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    return np.abs(one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0]) / 2


def _corners(mesh: Mesh) -> np.ndarray:
    """The vertices of each triangle, (T, 3)."""
    indices = np.arange(len(mesh.positions)) if mesh.indices is None else mesh.indices
    return indices.reshape(-1, 3)


def _with_images(material: Material, images: Mapping[TextureImage, TextureImage]) -> Material:
    """`material` with other images in its maps; itself if they are the same."""
    textures = {f"{name}_texture": each.texture(material) for name, each in MAPS.items()}
    changed: dict[str, Any] = {
        field: replace(texture, image=images[texture.image]) for field, texture in textures.items()
        if texture is not None and images[texture.image] is not texture.image}
    return replace(material, **changed) if changed else material
