"""Makes those of `scenes/*.glb` that show shapes, maps, lights and sizes: python assets/make_scenes.py"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from glb import Glb, Shape, arc, lathe, moved, plate, save_scenes, sphere, torus, without
from PIL import Image, ImageDraw, ImageFont

RED, GREEN, BLUE = (0.8, 0.05, 0.05), (0.05, 0.6, 0.1), (0.05, 0.15, 0.8)
UP = [-(0.5**0.5), 0.0, 0.0, 0.5**0.5]
"""The rotation (a quaternion) that lays a plate that faces +Z on the floor, facing +Y."""


def spheres() -> Glb:
    """Metallic from left to right, roughness from top to bottom."""
    glb, ball = Glb(), without(sphere(0.45, 32), "TEXCOORD_0", "TANGENT")
    for row, column in np.ndindex(4, 4):
        material = glb.material((1.0, 0.5, 0.2), column / 3, (0.05, 0.3, 0.6, 1.0)[row])
        glb.node(glb.mesh(ball, material), translation=[column - 1.5, 1.5 - row, 0])
    glb.camera((0, 0, 7.9))
    return glb


def normal_map() -> Glb:
    """Domes that stand out of a plate; light from the upper left. A flipped axis turns them into dents."""
    x = (np.arange(128) + 0.5) / 32 % 1 * 2 - 1
    x, y = x[None, :], -x[:, None]
    square = np.minimum(x**2 + y**2, 0.72)
    tilt = (x**2 + y**2 < 0.72)[..., None]
    normal = np.stack(np.broadcast_arrays(x, y, np.sqrt(1 - square)), -1) * np.where(tilt, 1, [0, 0, 1])
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    glb = Glb()
    texture = glb.texture(normal / 2 + 0.5)
    for place, scale, shape in ((-1.1, 1.0, plate(2, 2)), (1.1, 0.5, without(plate(2, 2), "TANGENT"))):
        material = glb.material((0.35, 0.35, 0.35), 0.0, 0.4, normalTexture=texture | {"scale": scale})
        glb.node(glb.mesh(shape, material), translation=[place, 0, 0])
    glb.light("directional", (-2, 2, 1.5), intensity=3.0)
    glb.camera((0, 0, 8.4))
    return glb


def textures() -> Glb:
    """Letters and corners that show orientation, wrap modes, filters, both UV sets and texture transforms."""
    picture = Image.new("RGB", (32, 32), (230, 230, 230))
    draw = ImageDraw.Draw(picture)
    for corner, colour in (((0, 0), "red"), ((24, 0), "lime"), ((0, 24), "blue"), ((24, 24), "yellow")):
        draw.rectangle([*corner, corner[0] + 7, corner[1] + 7], colour)
    draw.text((10, 4), "R", "black", ImageFont.load_default(20))
    pixels, glb = np.asarray(picture), Glb()
    repeat, clamp, mirror = 10497, 33071, 33648
    wide = plate(1, 1)
    wide["TEXCOORD_1"] = wide["TEXCOORD_0"] * 3 - 1
    wide = without(wide, "TANGENT")

    def transformed(**fields) -> dict:
        return {"extensions": {"KHR_texture_transform": fields}}

    kinds = [
        (dict(magFilter=9729), {}),
        (dict(magFilter=9728), {}),
        (dict(wrapS=repeat, wrapT=repeat), {"texCoord": 1}),
        (dict(wrapS=clamp, wrapT=clamp), {"texCoord": 1}),
        (dict(wrapS=mirror, wrapT=repeat), {"texCoord": 1}),
        (dict(magFilter=9729), transformed(offset=[0.25, 0.25], scale=[0.5, 0.5])),
        (dict(magFilter=9729), transformed(rotation=0.5, offset=[0, 0.4])),
        (dict(wrapS=clamp, wrapT=clamp), transformed(texCoord=1, scale=[-1, 1])),
    ]
    for place, (sampler, fields) in enumerate(kinds):
        material = glb.material(roughness=1.0, baseColorTexture=glb.texture(pixels, **sampler) | fields)
        glb.node(glb.mesh(wide, material), translation=[place % 4 * 1.1 - 1.65, 0.55 - place // 4 * 1.1, 0])
    glb.camera((0, 0, 8.6))
    return glb


def alpha() -> Glb:
    """A masked plate, three blended ones in an order that is wrong for any eye, and two that cut each other."""
    y, x = np.mgrid[-1:1:64j, -1:1:64j]
    ring = np.where(np.abs(np.hypot(x, y) - 0.7) < 0.2, 1.0, 0.0)
    glb = Glb()
    holes = glb.texture(np.stack([0 * x + 0.9, 0 * x + 0.7, 0 * x + 0.2, ring], -1))
    card = without(plate(1, 1), "TANGENT")
    mask = glb.material(roughness=0.6, baseColorTexture=holes, alphaMode="MASK", alphaCutoff=0.5, doubleSided=True)
    glb.node(glb.mesh(card, mask), translation=[-1.2, 0.1, 0])
    for depth, colour in ((0.3, RED), (-0.3, BLUE), (0.0, GREEN)):
        material = glb.material((*colour, 0.5), roughness=0.3, alphaMode="BLEND")
        glb.node(glb.mesh(card, material), translation=[depth * 0.6, 0.5 * depth, depth])
    for turn, colour in ((0.38, RED), (-0.38, GREEN)):
        material = glb.material((*colour, 0.6), roughness=0.5, alphaMode="BLEND", doubleSided=True)
        glb.node(glb.mesh(card, material), translation=[1.2, 0, 0], rotation=[0, np.sin(turn), 0, np.cos(turn)])
    floor = glb.material((0.5, 0.5, 0.5), roughness=0.9)
    glb.node(glb.mesh(plate(4, 2), floor), rotation=UP, translation=[0, -0.6, 0])
    glb.camera((0.8, 1.7, 7.4))
    return glb


def lights() -> Glb:
    """A grey floor with a ball, a ring and a post under a red point, a green spot and a blue directional light."""
    glb = Glb()
    floor, body = glb.material((0.25, 0.25, 0.25), roughness=0.8), glb.material((0.4, 0.4, 0.4), roughness=0.3)
    glb.node(glb.mesh(plate(6, 6), floor), rotation=UP)
    post = lathe([[0, 0], [0.15, 0]], [[0.15, 0], [0.15, 1.2]], [[0.15, 1.2], [0, 1.2]], segments=16)
    for shape, place in ((sphere(0.5, 32), [-1.2, 0.5, 0.2]), (torus(0.45, 0.15, 32, 12), [1.1, 0.6, 0.4]),
                         (post, [0, 0, -0.9])):
        glb.node(glb.mesh(without(shape, "TEXCOORD_0", "TANGENT"), body), translation=place)
    glb.light("point", (-2, 1.6, 1.2), color=[1, 0.2, 0.1], intensity=6.0, range=8.0)
    glb.light("spot", (1.5, 3, 1.5), (0.9, 0, 0.3), color=[0.2, 1, 0.3], intensity=25.0,
              spot={"innerConeAngle": 0.25, "outerConeAngle": 0.4})
    glb.light("directional", (2, 3, 3), color=[0.3, 0.4, 1], intensity=1.5)
    glb.camera((0, 4, 6.5), (0, 0.3, 0), 40)
    return glb


def vertex_colors() -> Glb:
    """Linear colours between the corners, as floats and as bytes with alpha, times a base colour."""
    glb, card = Glb(), without(plate(1, 1), "TANGENT", "TEXCOORD_0")
    corners = np.array([[1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1]], float)
    bytes_ = np.c_[corners, [1, 0.2, 1, 0.5]] * 255
    cases = [(corners, {}), (bytes_.astype(np.uint8), {"alphaMode": "BLEND"}), (corners, {"color": (1, 0.5, 0.5)})]
    for place, (colours, fields) in enumerate(cases):
        material = glb.material(roughness=1.0, **fields)
        glb.node(glb.mesh(card | {"COLOR_0": colours}, material), translation=[place * 1.1 - 1.1, 0, 0])
    glb.camera((0, 0, 6.6))
    return glb


def two_sided() -> Glb:
    """Open bowls, double-sided and not, upright and mirrored by a negative scale, one with a normal map."""
    glb = Glb()
    bowl = lathe(arc(0, 0, 0.5, -89.9, 20, 12), segments=32)
    stripes = np.full((8, 64, 3), [0.5, 0.5, 1.0])
    stripes[:, ::4, :] = [0.85, 0.5, 0.85]
    dents = {"normalTexture": glb.texture(stripes)}
    cases = [({}, 1, 1), ({"doubleSided": True}, 1, 1), ({}, -1, 1), ({"doubleSided": True}, -1, 1),
             ({"doubleSided": True} | dents, 1, 1), ({"doubleSided": True} | dents, -1, 1), ({}, 1, -1),
             ({"doubleSided": True}, -1, -1)]
    for place, (fields, x, y) in enumerate(cases):
        material = glb.material((0.8, 0.4, 0.2), 0.0, 0.35, **fields)
        glb.node(glb.mesh(bowl, material), translation=[place % 4 * 1.1 - 1.65, 0.6 - place // 4 * 1.2, 0],
                 scale=[x, y, 1])
    glb.light("directional", (-1, 2, 1), intensity=2.0)
    glb.camera((0, 3.7, 8))
    return glb


def lines_points() -> Glb:
    """All primitive modes: points, lines, loop, strip; triangles, strip and fan."""
    glb = Glb()
    angle = np.linspace(0, 2 * np.pi, 9)[:-1]
    star = np.stack([np.cos(angle), np.sin(angle), 0 * angle], -1) * np.where(np.arange(8) % 2, 0.22, 0.42)[:, None]
    zigzag = np.stack([np.repeat(np.linspace(-0.4, 0.4, 4), 2), np.tile([-0.3, 0.3], 4), np.zeros(8)], -1)
    for place, (mode, positions) in enumerate(zip(range(7), (star, star, star, star, zigzag[:6], zigzag, star))):
        shape = {"POSITION": positions, "COLOR_0": np.c_[np.linspace(1, 0.1, len(positions)),
                                                        np.linspace(0.1, 1, len(positions)),
                                                        np.full(len(positions), 0.3)]}
        shape["COLOR_0"] = shape["COLOR_0"][:len(positions)]
        material = glb.material(roughness=1.0, doubleSided=True, extensions={"KHR_materials_unlit": {}})
        glb.node(glb.mesh(shape, material, mode), translation=[place % 4 - 1.5, 0.5 - place // 4, 0])
    glb.camera((0, 0, 7.7))
    return glb


def occlusion() -> Glb:
    """A disc shaded by an occlusion map at strengths 0, 0.5 and 1: it dims light from all around, not a lamp's."""
    glb = Glb()
    y, x = np.mgrid[-1:1:64j, -1:1:64j]
    shade = glb.texture(np.clip(np.hypot(x, y) * 1.4 - 0.1, 0, 1))
    for place, strength in enumerate((0.0, 0.5, 1.0)):
        material = glb.material((0.8, 0.8, 0.8), 0.0, 0.5, occlusionTexture=shade | {"strength": strength})
        glb.node(glb.mesh(without(plate(1, 1), "TANGENT"), material), translation=[place * 1.1 - 1.1, 0.55, 0])
        material = glb.material((0.9, 0.7, 0.3), 1.0, 0.3, occlusionTexture=shade | {"strength": strength})
        glb.node(glb.mesh(without(plate(1, 1), "TANGENT"), material), translation=[place * 1.1 - 1.1, -0.55, 0])
    glb.camera((0, 0, 6.5))
    return glb


def arm() -> Glb:
    """An arm of three joints on a foot, which bows: nodes that move nodes."""
    glb = Glb()
    steel, paint = glb.material((0.6, 0.6, 0.62), 1.0, 0.3), glb.material((0.9, 0.35, 0.1), 0.0, 0.35)
    rod = lathe([[0, 0], [0.06, 0]], [[0.06, 0], [0.06, 1]], [[0.06, 1], [0, 1]], segments=24)
    foot = lathe([[0, 0], [0.45, 0]], [[0.45, 0], [0.45, 0.1]], [[0.45, 0.1], [0, 0.15]], segments=48)
    shade = lathe([[0.09, 0], [0.3, 0.35]], segments=32)
    rod, foot, shade, knob = (without(shape, "TEXCOORD_0", "TANGENT") for shape in (rod, foot, shade, sphere(0.11, 24)))
    two_sided = glb.material((0.9, 0.35, 0.1), 0.0, 0.35, doubleSided=True)
    head = glb.node(glb.mesh(shade, two_sided), root=False, translation=[0, 1, 0])
    upper_knob, lower_knob = (glb.node(glb.mesh(knob, steel), root=False) for _ in range(2))
    upper = glb.node(glb.mesh(rod, paint), root=False, children=[head, upper_knob], translation=[0, 1, 0])
    lower = glb.node(glb.mesh(rod, paint), children=[upper, lower_knob], translation=[0, 0.15, 0])
    glb.node(glb.mesh(foot, steel))
    times = [0.0, 0.5, 1.0, 1.5, 2.0]

    def about(degrees: list[float]) -> list[list[float]]:
        return [[0.0, 0.0, float(np.sin(half)), float(np.cos(half))] for half in np.radians(degrees) / 2]

    turns = {lower: about([20, 35, 20, -10, 20]), upper: about([-60, -95, -60, -20, -60]),
             head: about([-60, -40, -60, -90, -60])}
    for node, values in turns.items():
        glb.json["nodes"][node]["rotation"] = values[0]
    glb.animation("bow", *((node, "rotation", times, values) for node, values in turns.items()))
    glb.camera((0.2, 1.2, 6.5), (0.2, 0.8, 0))
    return glb


def _group(scale: float, offset=(0.0, 0.0, 0.0)) -> Glb:
    """A ball, a ring and a cone of some size somewhere, with the size in the vertices."""
    glb = Glb()
    cone = lathe([[0, -0.5], [0.5, -0.5]], [[0.5, -0.5], [0.25, 0], [0, 0.5]], segments=24)
    shapes: list[Shape] = [moved(sphere(0.5, 24), (-1, 0, 0)), moved(torus(0.35, 0.15, 32, 12), (0.1, 0, 0.5)),
                           moved(cone, (1, 0, 0))]
    for shape, colour, metal in zip(shapes, (RED, (0.9, 0.8, 0.5), BLUE), (0.0, 1.0, 0.0)):
        material = glb.material(colour, metal, 0.3)
        glb.node(glb.mesh(without(moved(shape, scale=scale), "TANGENT"), material), translation=list(offset))
    glb.light("directional", (1, 2, 2), intensity=2.0)
    return glb


def tiny() -> Glb:
    """Three micrometres across."""
    return _group(1e-6)


def huge() -> Glb:
    """Three thousand kilometres across, and ten times as far from the origin."""
    return _group(1e6, (3e7, 1e7, -2e7))


SCENES = [spheres, normal_map, textures, alpha, lights, vertex_colors, two_sided, lines_points, occlusion, arm, tiny,
          huge]

if __name__ == "__main__":
    save_scenes(SCENES, Path(__file__).parent / "scenes")
