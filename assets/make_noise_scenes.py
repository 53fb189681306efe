"""Makes `noise/*.glb`, scenes that are hard on a path tracer, one reason each: python assets/make_noise_scenes.py

They are meant without an environment (`--env none`) and from their own camera.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from glb import Glb, Shape, lathe, plate, pose, save_scenes, sphere, torus, without

WHITE, RED, GREEN, DARK = (0.75, 0.75, 0.75), (0.63, 0.065, 0.05), (0.14, 0.45, 0.091), (0.0, 0.0, 0.0)


def small_lights() -> Glb:
    """Eight lamps of 2 cm over a table: a direction drawn by the surface alone hits one in ten thousand times."""
    glb = Glb()
    _floor(glb, 8, _matte(glb, WHITE))
    for place, (roughness, metallic) in zip((-1.2, 0, 1.2), ((1.0, 0.0), (0.3, 0.0), (0.4, 1.0))):
        ball = glb.material((0.8, 0.5, 0.2), metallic, roughness)
        glb.node(glb.mesh(_smooth(sphere(0.5, 48)), ball), translation=[place, 0.5, 0])
    for k, hue in enumerate(np.linspace(0, 2 * np.pi, 8, endpoint=False)):
        color = 0.6 + 0.4 * np.cos(hue + np.array([0, 2, 4]))
        lamp = (1.8 * np.sin(hue), 1.6 + 0.1 * (k % 3), 1.2 * np.cos(hue))
        _panel(glb, 0.02, 0.02, lamp, (0, 0, 0), _glow(glb, 9e3, color))
    glb.camera((0, 1.6, 5.2), (0, 0.45, 0), 42)
    return glb


def reflections() -> Glb:
    """Four plates from mirror to satin under four balls of equal power and different size (Veach & Guibas 1995).

    The large balls in the smooth plates are found by sampling the surface, the small ones in the rough plates by
    sampling the lights; neither finds all.
    """
    glb = Glb()
    matte = _matte(glb, (0.4, 0.4, 0.4))
    _panel(glb, 20, 20, (0, 0, -3.0), (0, 0, 10), matte)
    _floor(glb, 20, matte, y=-1.2)
    lamp, eye = np.array([0, 2.6, 1.0]), np.array([0, 1.4, 11.0])
    for roughness, y, z in zip((0.07, 0.14, 0.22, 0.32), (1.35, 0.65, 0.0, -0.6), (-1.5, -1.2, -0.6, 0.3)):
        center = np.array([0, y, z])
        halfway = _unit(lamp - center) + _unit(eye - center)
        _panel(glb, 4.2, 0.6, center, center + halfway, glb.material((0.9, 0.9, 0.9), 1.0, roughness))
    for place, radius in zip((-1.65, -0.55, 0.55, 1.65), (0.033, 0.08, 0.18, 0.4)):
        ball = glb.mesh(_smooth(sphere(radius, 24)), _glow(glb, 0.25 / radius**2))
        glb.node(ball, translation=[place, *lamp[1:]])
    glb.camera(eye, (0, 1.0, 0), 24)
    return glb


def caustics() -> Glb:
    """A gold ring and a glass ball gather the light of a small, far lamp on the floor."""
    glb = Glb()
    _floor(glb, 7, _matte(glb, WHITE))
    ring = glb.material((1.0, 0.78, 0.34), 1.0, 0.1)
    glb.node(glb.mesh(_smooth(_band(0.75, 0.4)), ring), translation=[-0.9, 0.0, 0])
    glb.node(glb.mesh(_smooth(sphere(0.55, 64)), _glass(glb)), translation=[0.95, 0.7, 0])
    _panel(glb, 0.5, 0.5, (2.5, 5.0, 2.0), (0, 0, 0), _glow(glb, 350.0))
    glb.camera((0, 3.2, 5.6), (0, 0.2, 0), 38)
    return glb


def indirect() -> Glb:
    """A room lit by a lamp behind a screen: only light that has bounced twice or more reaches the camera's half."""
    glb = Glb()
    white = _room(glb)
    _panel(glb, 2.0, 1.5, (0, -0.25, -0.35), (0, -0.25, 1), white)
    _panel(glb, 2.0, 1.5, (0, -0.25, -0.36), (0, -0.25, -1), white)
    _panel(glb, 1.2, 0.3, (0, -0.6, -0.4), (0, -0.6, -1), _glow(glb, 150.0))
    glb.node(glb.mesh(_smooth(sphere(0.3, 48)), glb.material((0.9, 0.6, 0.3), 1.0, 0.3)), translation=[-0.4, -0.7, 0.3])
    glb.node(glb.mesh(_smooth(torus(0.22, 0.09, 48, 24)), white), translation=[0.45, -0.91, 0.4])
    glb.camera((0, 0, 3.9), (0, 0, 0), 39.3)
    return glb


def many_lights() -> Glb:
    """Four hundred lamps of 1 cm on the walls of a room, some a thousand times as strong as others."""
    glb, rng = Glb(), np.random.default_rng(4)
    white = _room(glb)
    glb.node(glb.mesh(_smooth(sphere(0.4, 48)), white), translation=[-0.35, -0.6, -0.2])
    glb.node(glb.mesh(_smooth(torus(0.3, 0.12, 48, 24)), glb.material((0.9, 0.9, 0.9), 1.0, 0.25)),
             translation=[0.45, -0.88, 0.2])
    lamps = [_glow(glb, strength, color) for strength in (5.0, 50.0, 500.0, 5000.0)
             for color in ((1, 0.8, 0.6), (0.6, 0.8, 1))]
    meshes = [glb.mesh(without(plate(0.01, 0.01), "TEXCOORD_0", "TANGENT"), lamp) for lamp in lamps]
    for _ in range(400):
        axis, side, at = rng.integers(3), rng.choice([-1.0, 1.0]), rng.uniform(-0.95, 0.95, 3)
        axis, side = (axis, side) if axis < 2 else (axis, -1.0)  # none on the camera's side
        at[axis] = 0.99 * side
        inwards = np.zeros(3)
        inwards[axis] = -side
        kind = rng.choice(8, p=np.repeat([0.4, 0.07, 0.02, 0.01], 2))
        glb.node(meshes[kind], matrix=pose(at, at - inwards))
    glb.camera((0, 0, 3.9), (0, 0, 0), 39.3)
    return glb


def unreachable() -> Glb:
    """A light without size and a ball of smooth glass: no path from the camera can ever meet the light through it.

    The bright spot below the ball is missing from every picture of a unidirectional tracer, however long it takes.
    """
    glb = Glb()
    _floor(glb, 7, _matte(glb, WHITE))
    glb.node(glb.mesh(_smooth(sphere(0.6, 64)), _glass(glb)), translation=[0, 0.8, 0])
    glb.light("point", (1.5, 4.0, 1.0), intensity=40.0)
    glb.camera((0, 2.6, 5.2), (0, 0.35, 0), 30)
    return glb


SCENES = [small_lights, reflections, caustics, indirect, many_lights, unreachable]


def _matte(glb: Glb, color, extensions: dict | None = None, **fields) -> int:
    """Lambertian: nothing is reflected at an interface."""
    dull = {"KHR_materials_specular": {"specularFactor": 0.0}}
    return glb.material(color, roughness=1.0, extensions=dull | (extensions or {}), **fields)


def _glow(glb: Glb, radiance: float, color=(1, 1, 1)) -> int:
    """Black, but it shines with `radiance` times `color`."""
    strength = {"KHR_materials_emissive_strength": {"emissiveStrength": radiance}}
    return _matte(glb, DARK, strength, emissiveFactor=[float(c) for c in color])


def _glass(glb: Glb) -> int:
    return glb.material((1, 1, 1), 0.0, 0.0, extensions={
        "KHR_materials_transmission": {"transmissionFactor": 1.0},
        "KHR_materials_volume": {"thicknessFactor": 1.0}, "KHR_materials_ior": {"ior": 1.5}})


def _room(glb: Glb) -> int:
    """A box from -1 to 1, red on the left and green on the right, open towards the camera; its white material."""
    white, red, green = (_matte(glb, color) for color in (WHITE, RED, GREEN))
    for center, material in (((0, -1, 0), white), ((0, 1, 0), white), ((0, 0, -1), white), ((-1, 0, 0), red),
                             ((1, 0, 0), green)):
        _panel(glb, 2, 2, center, (0, 0, 0), material)
    return white


def _floor(glb: Glb, size: float, material: int, y: float = 0.0) -> None:
    _panel(glb, size, size, (0, y, 0), (0, y + 1, 0), material)


def _panel(glb: Glb, width: float, height: float, center, towards, material: int) -> None:
    """A rectangle at `center` that faces `towards`."""
    center = np.asarray(center, float)
    shape = without(plate(width, height), "TEXCOORD_0", "TANGENT")
    glb.node(glb.mesh(shape, material), matrix=pose(center, 2 * center - np.asarray(towards, float)))


def _band(radius: float, height: float) -> Shape:
    """A flat ring that stands on the floor, thin but closed."""
    inner = radius - 0.04
    return lathe([[radius, 0], [radius, height]], [[radius, height], [inner, height]], [[inner, height], [inner, 0]],
                 segments=96)


def _smooth(shape: Shape) -> Shape:
    return without(shape, "TEXCOORD_0", "TANGENT")


def _unit(vector: np.ndarray) -> np.ndarray:
    return vector / np.linalg.norm(vector)


if __name__ == "__main__":
    save_scenes(SCENES, Path(__file__).parent / "noise")
