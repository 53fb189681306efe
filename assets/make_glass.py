"""Makes `glass/tumbler.glb`, water and ice in a tumbler on a table, in decimetres: python assets/make_glass.py"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from glb import Glb, Shape, lathe, plate, save_scenes, sphere, without

HEIGHT, BOTTOM, LEVEL = 1.0, 0.12, 0.72
"""Of the rim, of the inside's bottom, and of the water."""
OUTER, INNER = (0.36, 0.42), (0.31, 0.38)
"""Radii of the walls at the table or the inside's bottom, and at the rim."""


def rounded_cube(half: float, power: float = 7.0, segments: int = 36) -> Shape:
    """The surface where |x|^p + |y|^p + |z|^p is the same everywhere."""
    shape = without(sphere(1.0, segments), "TEXCOORD_0", "TANGENT")
    p = shape["POSITION"]
    p = half * p / (np.abs(p)**power).sum(axis=1, keepdims=True)**(1 / power)
    n = np.sign(p) * np.abs(p / half)**(power - 1)
    return shape | {"POSITION": p, "NORMAL": n / np.linalg.norm(n, axis=1, keepdims=True)}


def tumbler() -> Glb:
    """The water touches the glass exactly, and the ice floats in both water and air."""
    glb = Glb()
    transmission, volume = "KHR_materials_transmission", "KHR_materials_volume"

    def solid(ior: float, **more) -> int:
        return glb.material(roughness=0.0, extensions={
            transmission: {"transmissionFactor": 1.0}, "KHR_materials_ior": {"ior": ior},
            volume: {"thicknessFactor": 0.1} | more})

    rim = [[OUTER[1], HEIGHT], [INNER[1], HEIGHT]]
    wall = np.array([[INNER[1], HEIGHT], [INNER[0], BOTTOM]])
    glass = lathe([[0, 0], [OUTER[0], 0]], [[OUTER[0], 0], [OUTER[1], HEIGHT]], rim, wall,
                  [[INNER[0], BOTTOM], [0, BOTTOM]], segments=96)
    at_level = float(np.interp(LEVEL, wall[::-1, 1], wall[::-1, 0]))
    water = lathe([[0, BOTTOM], [INNER[0], BOTTOM]], [[INNER[0], BOTTOM], [at_level, LEVEL]],
                  [[at_level, LEVEL], [0, LEVEL]], segments=96)
    table = glb.material((0.45, 0.33, 0.24), 0.0, 0.6)
    glb.node(glb.mesh(without(plate(8, 8), "TEXCOORD_0", "TANGENT"), table), rotation=[-(0.5**0.5), 0, 0, 0.5**0.5],
             translation=[0, -0.001, 0])
    glb.node(glb.mesh(without(glass, "TEXCOORD_0", "TANGENT"), solid(1.5)))
    tea = {"attenuationDistance": 0.8, "attenuationColor": [0.85, 0.55, 0.2]}
    glb.node(glb.mesh(without(water, "TEXCOORD_0", "TANGENT"), solid(1.33, **tea)))
    ice, frozen = rounded_cube(0.13), solid(1.31)
    for place, axis, angle in (((0.12, 0.68, 0.1), (0.3, 1.0, 0.2), 0.6), ((-0.14, 0.7, -0.06), (1.0, 0.4, -0.3), 0.5)):
        q = np.array(axis) / np.linalg.norm(axis) * np.sin(angle / 2)
        glb.node(glb.mesh(ice, frozen), translation=list(place), rotation=[*q.tolist(), float(np.cos(angle / 2))])
    glb.light("directional", (-1.2, 1.6, 0.6), intensity=3.0)
    glb.camera((0.6, 1.15, 2.6), (0, 0.46, 0), fov=30.0)
    return glb


if __name__ == "__main__":
    save_scenes([tumbler], Path(__file__).parent / "glass")
