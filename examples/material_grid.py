"""Builds a scene from numpy arrays: spheres by roughness (left to right) and metalness (bottom to top).

    python examples/material_grid.py [OUT]
"""

from __future__ import annotations

import sys

import numpy as np

import viewer

ROUGHNESS, METALLIC = np.linspace(0, 1, 7), np.linspace(0, 1, 3)


def sphere(material: int, segments: int = 64) -> viewer.Mesh:
    """Radius 0.45 about the origin; a grid of (segments / 2 + 1) x (segments + 1) vertices."""
    polar, azimuth = np.mgrid[0:np.pi:(segments // 2 + 1) * 1j, 0:2 * np.pi:(segments + 1) * 1j]
    normals = np.stack([np.sin(polar) * np.sin(azimuth), np.cos(polar), np.sin(polar) * np.cos(azimuth)], axis=-1)
    corner = np.arange(normals[..., 0].size, dtype=np.uint32).reshape(polar.shape)
    a, b, c, d = corner[:-1, :-1], corner[1:, :-1], corner[1:, 1:], corner[:-1, 1:]
    normals = normals.reshape(-1, 3).astype(np.float32)
    return viewer.Mesh("sphere", 0.45 * normals, material, indices=np.stack([a, b, c, a, c, d], axis=-1).ravel(),
                       normals=normals)


def main(out: str = "grid.png", *, size: tuple[int, int] = (1120, 480)) -> None:
    cells = [(x, y) for y in range(len(METALLIC)) for x in range(len(ROUGHNESS))]
    materials = [viewer.Material(base_color=(0.9, 0.5, 0.2, 1), metallic=METALLIC[y], perceptual_roughness=ROUGHNESS[x])
                 for x, y in cells]
    places = [np.array([[1, 0, 0, x], [0, 1, 0, y], [0, 0, 1, 0], [0, 0, 0, 1]], float) for x, y in cells]
    radiance = np.full((64, 128, 3), 0.3, np.float32)  # an environment is an array of radiance, row 0 the zenith
    radiance[8:28, 68:88] = 6  # with a window in it, above and to the right of the camera
    scene = viewer.Scene("grid", tuple(sphere(k) for k in range(len(cells))), tuple(materials),
                         tuple(viewer.Instance(k, place) for k, place in enumerate(places)),
                         environment=viewer.Environment("window", radiance))
    camera = viewer.Camera.orbit(scene.center, 12, azimuth=0, elevation=0, fov_y=np.radians(16))
    viewer.render(scene, size, camera, background="none").save(out)


if __name__ == "__main__":
    main(*sys.argv[1:])
