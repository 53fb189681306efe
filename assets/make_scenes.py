"""Makes `scenes/*.glb`, the small scenes of the golden images: python assets/make_scenes.py"""

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


def emissive() -> Glb:
    """Balls that glow: by a factor, by KHR_materials_emissive_strength 1, 4 and 16, and by a texture."""
    glb, ball = Glb(), without(sphere(0.45, 24), "TANGENT")
    bands = np.zeros((32, 64, 3))
    bands[8:24:4, :, :] = [0.1, 0.9, 1]
    bands[:, ::16, :] = [1, 0.3, 0.9]
    for place, strength in enumerate((None, 1.0, 4.0, 16.0)):
        fields = {"extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": strength}}} if strength else {}
        material = glb.material((0.05, 0.05, 0.05), roughness=0.4, emissiveFactor=[0.9, 0.35, 0.05], **fields)
        glb.node(glb.mesh(ball, material), translation=[place - 2, 0, 0])
    material = glb.material((0.05, 0.05, 0.05), roughness=0.4, emissiveFactor=[1, 1, 1],
                            emissiveTexture=glb.texture(bands))
    glb.node(glb.mesh(ball, material), translation=[2, 0, 0])
    glb.camera((0, 0, 9.8))
    return glb


def unlit() -> Glb:
    """The colours as they are, whatever the light: a grey ramp, a tinted texture, blending; a lit ball beside them."""
    glb = Glb()
    card, ramp = without(plate(1, 1), "TANGENT"), np.broadcast_to(np.linspace(0, 1, 64), (8, 64))
    fields = {"extensions": {"KHR_materials_unlit": {}}, "baseColorTexture": glb.texture(np.stack([ramp] * 3, -1))}
    for place, colour, blend in ((-1.65, (1, 1, 1), {}), (-0.55, (1, 0.5, 0.1), {}),
                                 (0.55, (0.2, 0.4, 1, 0.5), {"alphaMode": "BLEND"})):
        glb.node(glb.mesh(card, glb.material(colour, **fields, **blend)), translation=[place, 0, 0])
    glb.node(glb.mesh(without(sphere(0.5), "TANGENT"), glb.material((1, 1, 1))), translation=[1.65, 0, 0])
    glb.camera((0, 0, 8.6))
    return glb


def specular_ior() -> Glb:
    """Above: index of refraction 1, 1.33, 1.5, 2.4. Below: specular 0, 0.5, a coloured one, and one on a metal."""
    glb, ball = Glb(), without(sphere(0.45), "TEXCOORD_0", "TANGENT")
    upper = [{"KHR_materials_ior": {"ior": ior}} for ior in (1.0, 1.33, 1.5, 2.4)]
    lower = [{"KHR_materials_specular": fields} for fields in (
        {"specularFactor": 0.0}, {"specularFactor": 0.5}, {"specularColorFactor": [4, 0.4, 0.1]},
        {"specularFactor": 0.5, "specularColorFactor": [0.2, 0.5, 1]})]
    for place, extensions in enumerate(upper + lower):
        material = glb.material((0.12, 0.12, 0.14), float(place == 7), 0.15, extensions=extensions)
        glb.node(glb.mesh(ball, material), translation=[place % 4 - 1.5, 0.5 - place // 4, 0])
    glb.light("directional", (1, 2, 2), intensity=2.0)
    glb.camera((0, 0, 7.9))
    return glb


def glass() -> Glb:
    """In front of a chequered wall, from the upper left: clear, rough, coloured by its volume, and a thin shell of a
    base colour; then transmission by a texture, thickness by one, half of it with some metal, and water, rough."""
    glb, ball = Glb(), without(sphere(0.45, 32), "TANGENT")
    rows, columns = np.indices((8, 16))
    squares = np.where(((rows + columns) % 2)[..., None], [0.85, 0.8, 0.7], np.stack(
        [columns / 16, 0.2 + 0.05 * rows, 0.8 - columns / 20], -1))
    nearest = {"magFilter": 9728, "minFilter": 9728}
    wall = glb.material((1, 1, 1), 0.0, 1.0, baseColorTexture=glb.texture(squares, **nearest),
                        extensions={"KHR_materials_specular": {"specularFactor": 0.0}})
    glb.node(glb.mesh(without(plate(5, 2.5), "TANGENT"), wall), translation=[0, 0, -0.9])
    bands = np.zeros((8, 8, 3), np.uint8)
    bands[::2, :, 0], bands[:, :4, 1] = 255, 255
    maps = glb.texture(bands, **nearest)
    solid = {"thicknessFactor": 0.9}
    cases = [
        ({}, solid, {}), ({"roughness": 0.4}, solid, {}),
        ({}, solid | {"attenuationDistance": 0.4, "attenuationColor": [0.3, 0.8, 0.5]}, {}),
        ({"color": (1.0, 0.6, 0.3), "doubleSided": True}, None, {}),
        ({"color": (0.9, 0.3, 0.2)}, solid, {"transmissionTexture": maps}),
        ({}, solid | {"thicknessTexture": maps, "attenuationDistance": 0.5, "attenuationColor": [0.8, 0.2, 0.2]}, {}),
        ({"color": (0.3, 0.5, 0.9), "metallic": 0.3, "roughness": 0.2}, solid, {"transmissionFactor": 0.5}),
        ({"roughness": 0.6, "ior": 1.33}, solid, {}),
    ]
    for place, (fields, volume, transmission) in enumerate(cases):
        extensions = {"KHR_materials_transmission": {"transmissionFactor": 1.0} | transmission,
                      "KHR_materials_ior": {"ior": fields.pop("ior", 1.5)}}
        extensions |= {"KHR_materials_volume": volume} if volume else {}
        material = glb.material(**{"roughness": 0.05} | fields, extensions=extensions)
        glb.node(glb.mesh(ball, material), translation=[place % 4 * 1.1 - 1.65, 0.55 - place // 4 * 1.1, 0])
    glb.light("directional", (1, 2, 2), intensity=2.0)
    glb.camera((0.4, 0.3, 9.3))
    return glb


def anisotropy() -> Glb:
    """Brushed balls. Above: strength 0.5, 1, turned by 45 degrees, and mirrored by a negative scale. Below: directions
    and strength by a texture, that texture turned by 90 degrees, a dielectric, and a mesh without tangents."""
    glb, ball = Glb(), sphere(0.45)
    angles = np.linspace(0, np.pi, 8, endpoint=False)[None, :] * np.ones((8, 1))
    strength = np.linspace(1.0, 0.3, 8)[:, None] * np.ones((1, 8))
    texture = glb.texture(np.stack([np.cos(angles) / 2 + 0.5, np.sin(angles) / 2 + 0.5, strength], -1))
    full = {"anisotropyStrength": 1.0}
    cases = [
        ({"anisotropyStrength": 0.5}, 1.0, ball), (full, 1.0, ball),
        (full | {"anisotropyRotation": float(np.pi / 4)}, 1.0, ball),
        (full | {"anisotropyRotation": float(np.pi / 4)}, 1.0, ball),
        (full | {"anisotropyTexture": texture}, 1.0, ball),
        (full | {"anisotropyTexture": texture, "anisotropyRotation": float(np.pi / 2)}, 1.0, ball),
        (full, 0.0, ball), (full, 1.0, without(ball, "TANGENT")),
    ]
    for place, (fields, metallic, shape) in enumerate(cases):
        material = glb.material((0.9, 0.75, 0.5), metallic, 0.35, extensions={"KHR_materials_anisotropy": fields})
        glb.node(glb.mesh(shape, material), translation=[place % 4 * 1.1 - 1.65, 0.55 - place // 4 * 1.1, 0],
                 scale=[-1.0 if place == 3 else 1.0, 1.0, 1.0])
    glb.light("directional", (1, 2, 2), intensity=2.0)
    glb.camera((0, 0, 8.6))
    return glb


def specular_glossiness() -> Glb:
    """Old materials. Above: plastic, rough copper, a mirror, and without any factor. Below: f0 and glossiness by a
    texture of RGBA, the texture with factors, the diffuse colour and holes by a texture, and both."""
    glb, ball = Glb(), without(sphere(0.45), "TANGENT")
    f0 = np.linspace([0.04, 0.04, 0.04], [0.9, 0.6, 0.2], 8)[:, None, :] * np.ones((1, 16, 1))
    glossiness = np.where(np.arange(16) % 4 < 2, 0.9, 0.4)[None, :, None] * np.ones((8, 1, 1))
    gloss = glb.texture(np.concatenate([f0 ** (1 / 2.2), glossiness], -1), magFilter=9729)
    y, x = np.mgrid[:8, :8]
    holes = np.stack([0.2 + 0.08 * x, 0.8 - 0.08 * y, 0.5 + 0 * x, np.where((x + y) % 4, 1.0, 0.0)], -1)
    diffuse = glb.texture(holes, magFilter=9728, minFilter=9728)
    cases = [
        {"diffuseFactor": [0.1, 0.3, 0.6, 1], "specularFactor": [0.05, 0.05, 0.05], "glossinessFactor": 0.7},
        {"diffuseFactor": [0, 0, 0, 1], "specularFactor": [0.95, 0.64, 0.54], "glossinessFactor": 0.5},
        {"diffuseFactor": [0.8, 0.8, 0.8, 1], "specularFactor": [1, 1, 1]}, {},
        {"diffuseFactor": [0.6, 0.6, 0.6, 1], "specularGlossinessTexture": gloss},
        {"diffuseFactor": [0.6, 0.2, 0.2, 1], "specularGlossinessTexture": gloss, "specularFactor": [0.2, 0.6, 0.9],
         "glossinessFactor": 0.6},
        {"diffuseTexture": diffuse, "specularFactor": [0.2, 0.2, 0.2], "glossinessFactor": 0.8},
        {"diffuseTexture": diffuse, "specularGlossinessTexture": gloss},
    ]
    for place, fields in enumerate(cases):
        alpha = {"alphaMode": "MASK", "doubleSided": True} if "diffuseTexture" in fields else {}
        # What readers without the extension see is wrong on purpose.
        extensions = {"KHR_materials_pbrSpecularGlossiness": fields}
        material = glb.material((1, 0, 1), 1.0, 1.0, extensions=extensions, **alpha)
        glb.node(glb.mesh(ball, material), translation=[place % 4 * 1.1 - 1.65, 0.55 - place // 4 * 1.1, 0])
    glb.light("directional", (1, 2, 2), intensity=2.0)
    glb.camera((0, 0, 8.6))
    return glb


def dispersion() -> Glb:
    """Balls of glass before stripes of black and white: dispersion 0, 1, 5, and 5 of a higher index and rough."""
    glb, ball = Glb(), without(sphere(0.5, 48), "TANGENT")
    stripes = np.where(np.arange(16) % 2, 0.9, 0.02)[None, :, None] * np.ones((2, 16, 3))
    nearest = {"magFilter": 9728, "minFilter": 9728}
    wall = glb.material((1, 1, 1), 0.0, 1.0, baseColorTexture=glb.texture(stripes, **nearest),
                        extensions={"KHR_materials_specular": {"specularFactor": 0.0}})
    glb.node(glb.mesh(without(plate(6, 3), "TANGENT"), wall), translation=[0, 0, -1.2])
    for place, (dispersion, ior, roughness) in enumerate(((0, 1.5, 0.0), (1, 1.5, 0.0), (5, 1.5, 0.0), (5, 1.8, 0.2))):
        extensions = {"KHR_materials_transmission": {"transmissionFactor": 1.0}, "KHR_materials_ior": {"ior": ior},
                      "KHR_materials_volume": {"thicknessFactor": 1.0}}
        extensions |= {"KHR_materials_dispersion": {"dispersion": dispersion}} if dispersion else {}
        glb.node(glb.mesh(ball, glb.material(roughness=roughness, extensions=extensions)),
                 translation=[place % 2 * 1.15 - 0.575, 0.575 - place // 2 * 1.15, 0])
    glb.light("directional", (1, 2, 2), intensity=2.0)
    glb.camera((0, 0, 5.5))
    return glb


def rough_diffuse() -> Glb:
    """Balls of plaster, lit from behind the eye and from the side: diffuse roughness 0, 0.5, 1, and by a texture; below
    the same under a smooth interface, and the last of it metal, which has no diffuse base."""
    glb, ball = Glb(), without(sphere(0.45), "TANGENT")
    bands = glb.texture(np.where(np.arange(8) % 2, 1.0, 0.2)[None, :, None] * np.ones((8, 1, 3)), magFilter=9728)
    kinds = [{}, {"diffuseRoughnessFactor": 0.5}, {"diffuseRoughnessFactor": 1.0},
             {"diffuseRoughnessFactor": 1.0, "diffuseRoughnessTexture": bands}]
    for place in range(8):
        extensions = {"KHR_materials_diffuse_roughness": kinds[place % 4]}
        if place < 4:
            extensions["KHR_materials_specular"] = {"specularFactor": 0.0}
        material = glb.material((0.85, 0.6, 0.45), float(place == 7), 0.2, extensions=extensions)
        glb.node(glb.mesh(ball, material), translation=[place % 4 * 1.1 - 1.65, 0.55 - place // 4 * 1.1, 0])
    glb.light("directional", (0.3, 0.2, 2), intensity=2.0)
    glb.light("directional", (-2, 0.5, 0.3), color=[0.4, 0.6, 1.0], intensity=1.5)
    glb.camera((0, 0, 8.6))
    return glb


def _waves(along: int) -> np.ndarray:
    """A normal map of waves along u (0) or v (1)."""
    slope = 0.6 * np.sin(np.arange(64) / 64 * 2 * np.pi * 6)
    slope = np.broadcast_to(slope[None, :] if along == 0 else slope[:, None], (64, 64))
    normal = np.stack([slope if along == 0 else 0 * slope, slope if along else 0 * slope, 1 + 0 * slope], -1)
    return normal / np.linalg.norm(normal, axis=-1, keepdims=True) / 2 + 0.5


def clearcoat() -> Glb:
    """Clear coats. Above: over rough metal, smooth, half as strong, rough, and by textures of weight and roughness.
    Below: over a normal map, waves of the coat alone, waves across those of the base, and over emission."""
    glb, ball = Glb(), sphere(0.45, 32)
    stripes = np.zeros((8, 16, 3))
    stripes[:, ::2, 0] = 1.0
    stripes[..., 1] = np.linspace(0.1, 1.0, 8)[:, None]
    texture = glb.texture(stripes, magFilter=9728)
    base, own = glb.texture(_waves(0)), glb.texture(_waves(1))
    full, gold = {"clearcoatFactor": 1.0}, ((0.9, 0.6, 0.2), 1.0, 0.5)
    red, black = ((0.5, 0.02, 0.02), 0.0, 0.6), ((0.0, 0.0, 0.0), 0.0, 1.0)
    cases = [
        (gold, full, {}), (gold, {"clearcoatFactor": 0.5}, {}), (gold, full | {"clearcoatRoughnessFactor": 0.4}, {}),
        (red, full | {"clearcoatTexture": texture, "clearcoatRoughnessTexture": texture,
                      "clearcoatRoughnessFactor": 0.5}, {}),
        (red, full, {"normalTexture": base}),
        (black, full | {"clearcoatNormalTexture": own | {"scale": 0.7}, "clearcoatRoughnessFactor": 0.3}, {}),
        (gold, full | {"clearcoatNormalTexture": own}, {"normalTexture": base}),
        (black, full, {"emissiveFactor": [0.2, 0.7, 0.3]}),
    ]
    for place, ((color, metallic, roughness), fields, others) in enumerate(cases):
        material = glb.material(color, metallic, roughness, extensions={"KHR_materials_clearcoat": fields}, **others)
        glb.node(glb.mesh(ball, material), translation=[place % 4 * 1.1 - 1.65, 0.55 - place // 4 * 1.1, 0])
    glb.light("directional", (1, 2, 2), intensity=2.0)
    glb.camera((0, 0, 8.6))
    return glb


def translucent() -> Glb:
    """Lit from behind and from the front. Above: paper, a leaf with veins by a texture of the share and another of the
    colour, a sheet that lets everything through, and one with a ball between it and the light. Below: a ball of wax,
    one that absorbs, a lamp shade open at both ends, and half metal."""
    glb, ball, sheet = Glb(), without(sphere(0.42), "TANGENT"), without(plate(0.9, 0.9), "TANGENT")
    veins = np.where((np.arange(16)[:, None] % 5 == 0) | (np.arange(16) % 7 == 3), 0.2, 1.0)[..., None]
    share = glb.texture(np.concatenate([np.ones((16, 16, 3)), veins], -1))
    color = glb.texture(np.concatenate([0.3 + 0.5 * veins, 0.9 * veins, 0.1 * veins], -1))
    shade = lathe([[0.42, -0.3], [0.25, 0.35]], segments=32)
    wax = {"thicknessFactor": 0.84}
    kinds = [
        (sheet, {"diffuseTransmissionFactor": 0.4}, None, {}),
        (sheet, {"diffuseTransmissionFactor": 0.8, "diffuseTransmissionTexture": share,
                 "diffuseTransmissionColorTexture": color}, None, {"color": (0.2, 0.5, 0.1)}),
        (sheet, {"diffuseTransmissionFactor": 1.0, "diffuseTransmissionColorFactor": [0.9, 0.3, 0.2]}, None, {}),
        (sheet, {"diffuseTransmissionFactor": 0.5}, None, {}),
        (ball, {"diffuseTransmissionFactor": 0.6}, wax, {"roughness": 0.3}),
        (ball, {"diffuseTransmissionFactor": 0.8}, wax | {"attenuationDistance": 0.6,
                                                         "attenuationColor": [0.9, 0.5, 0.2]}, {}),
        (shade, {"diffuseTransmissionFactor": 0.6, "diffuseTransmissionColorFactor": [1.0, 0.8, 0.5]}, None, {}),
        (sheet, {"diffuseTransmissionFactor": 0.8}, None, {"metallic": 0.5}),
    ]
    for place, (shape, fields, volume, material) in enumerate(kinds):
        extensions = {"KHR_materials_diffuse_transmission": fields}
        extensions |= {"KHR_materials_volume": volume} if volume else {}
        look = {"color": (0.8, 0.8, 0.75), "roughness": 0.7} | material
        number = glb.material(**look, doubleSided=volume is None, extensions=extensions)
        glb.node(glb.mesh(shape, number), translation=[place % 4 * 1.1 - 1.65, 0.55 - place // 4 * 1.1, 0])
    glb.node(glb.mesh(without(sphere(0.2), "TANGENT", "TEXCOORD_0"), glb.material((0.1, 0.1, 0.1))),
             translation=[1.65, 0.55, -0.5])
    glb.light("directional", (0.2, 0.4, -2), intensity=3.0)
    glb.light("point", (-1, 1.2, 1.5), color=[1, 0.6, 0.3], intensity=3.0)
    glb.camera((0, 0, 8.6))
    return glb


def subsurface() -> Glb:
    """Solids that scatter light inside, lit from behind and, through slats, from the front. A head of wax with ears,
    milk with a rough boundary, a medium without one, and a ball whose diffuse boundary lets light in."""
    glb, ball = Glb(), without(sphere(0.45), "TANGENT", "TEXCOORD_0")
    volume = {"thicknessFactor": 0.9, "attenuationDistance": 0.1}
    kinds = [
        ({"KHR_materials_transmission": {"transmissionFactor": 1.0}, "KHR_materials_ior": {"ior": 1.4}},
         [0.5, 0.35, 0.2], [0.85, 0.6, 0.35], 0.0, {"roughness": 0.4}),
        ({"KHR_materials_transmission": {"transmissionFactor": 1.0}, "KHR_materials_ior": {"ior": 1.33}},
         [0.5, 0.5, 0.5], [0.9, 0.9, 0.85], 0.5, {"roughness": 0.55}),
        ({"KHR_materials_transmission": {"transmissionFactor": 1.0}, "KHR_materials_ior": {"ior": 1.0}},
         [0.8, 0.6, 0.4], [0.5, 0.7, 0.9], 0.0, {"roughness": 0.0}),
        ({"KHR_materials_diffuse_transmission": {"diffuseTransmissionFactor": 0.9}},
         [0.6, 0.3, 0.1], [0.9, 0.5, 0.3], 0.0, {"color": (0.8, 0.8, 0.8), "roughness": 0.6}),
    ]
    for place, (extensions, attenuation, scatter, g, look) in enumerate(kinds):
        extensions = extensions | {
            "KHR_materials_volume": volume | {"attenuationColor": attenuation},
            "KHR_materials_volume_scatter": {"multiscatterColorFactor": scatter, "scatterAnisotropy": g}}
        mesh = glb.mesh(ball, glb.material(**look, extensions=extensions))
        x, y = place % 2 * 1.3 - 0.65, 0.65 - place // 2 * 1.3
        glb.node(mesh, translation=[x, y, 0])
        if place == 0:
            for side in (-0.5, 0.5):
                glb.node(mesh, translation=[x + side, y + 0.1, 0], scale=[0.35, 0.45, 0.08])
    for k in range(5):
        glb.node(glb.mesh(plate(0.12, 3), glb.material(doubleSided=True)), translation=[k * 0.6 - 1.3, 3.0, 3.0])
    glb.light("directional", (0.3, 0.5, -2), intensity=4.0)
    glb.light("directional", (0, 2, 2), intensity=2.0)
    glb.camera((0, 0, 5.6))
    return glb


def sheen() -> Glb:
    """Cloth. Above: sheen of roughness 0.2, 0.5 and 1, and coloured. Below: colour and roughness by a texture, over
    smooth plastic, under a clear coat, and over metal."""
    glb, ball = Glb(), without(sphere(0.45), "TANGENT")
    stripes = np.ones((8, 16, 4)) * [0.9, 0.4, 0.1, 1.0]
    stripes[:, ::4] = [0.1, 0.5, 0.9, 0.4]
    texture = glb.texture(stripes, magFilter=9728, minFilter=9728)
    white = {"sheenColorFactor": [1, 1, 1]}
    cases = [
        (0.0, 0.9, white | {"sheenRoughnessFactor": 0.2}, {}), (0.0, 0.9, white | {"sheenRoughnessFactor": 0.5}, {}),
        (0.0, 0.9, white | {"sheenRoughnessFactor": 1.0}, {}),
        (0.0, 0.9, {"sheenColorFactor": [0.2, 0.9, 0.4], "sheenRoughnessFactor": 0.4}, {}),
        (0.0, 0.9, white | {"sheenColorTexture": texture, "sheenRoughnessTexture": texture,
                            "sheenRoughnessFactor": 0.8}, {}),
        (0.0, 0.2, white | {"sheenRoughnessFactor": 0.6}, {}),
        (0.0, 0.9, white | {"sheenRoughnessFactor": 0.6}, {"KHR_materials_clearcoat": {"clearcoatFactor": 1.0}}),
        (1.0, 0.4, white | {"sheenRoughnessFactor": 0.6}, {}),
    ]
    for place, (metallic, roughness, fields, others) in enumerate(cases):
        material = glb.material((0.3, 0.03, 0.06), metallic, roughness,
                                extensions={"KHR_materials_sheen": fields, **others})
        glb.node(glb.mesh(ball, material), translation=[place % 4 * 1.1 - 1.65, 0.55 - place // 4 * 1.1, 0])
    glb.light("directional", (-2, 1, 0.4), intensity=3.0)
    glb.camera((0, 0, 8.6))
    return glb


def iridescence() -> Glb:
    """Films. Above: over black plastic, over gold, over a mixture with the thickness by a texture, over rough clay.
    Below: weight by a texture, under a clear coat, on thin-walled and on solid glass."""
    glb, ball = Glb(), without(sphere(0.45), "TANGENT")
    waves = np.ones((16, 16, 4))
    wave = 0.5 + 0.5 * np.sin(np.arange(16) / 16 * 2 * np.pi)
    waves[..., 0], waves[..., 1] = wave[:, None], np.roll(wave, 4)  # weight and thickness lie in different channels
    texture = glb.texture(waves, magFilter=9728, minFilter=9728)
    full = {"iridescenceFactor": 1.0}
    clear = {"KHR_materials_transmission": {"transmissionFactor": 1.0}}
    solid = clear | {"KHR_materials_volume": {"thicknessFactor": 0.5}}
    cases = [
        ((0.02,) * 3, 0.0, 0.15, full | {"iridescenceIor": 1.8, "iridescenceThicknessMaximum": 350}, {}),
        ((1.0, 0.77, 0.34), 1.0, 0.3, full | {"iridescenceThicknessMaximum": 300}, {}),
        ((0.4,) * 3, 0.5, 0.3, full | {"iridescenceIor": 2.0, "iridescenceThicknessMinimum": 420,
                                       "iridescenceThicknessMaximum": 180, "iridescenceThicknessTexture": texture}, {}),
        ((0.5, 0.2, 0.1), 0.0, 0.6, full | {"iridescenceIor": 2.5, "iridescenceThicknessMaximum": 120}, {}),
        ((0.9,) * 3, 1.0, 0.2, full | {"iridescenceTexture": texture}, {}),
        ((0.6,) * 3, 1.0, 0.5, full | {"iridescenceIor": 1.6, "iridescenceThicknessMaximum": 250},
         {"KHR_materials_clearcoat": {"clearcoatFactor": 1.0}}),
        ((1.0,) * 3, 0.0, 0.1, full | {"iridescenceIor": 2.2, "iridescenceThicknessMaximum": 260}, clear),
        ((1.0,) * 3, 0.0, 0.1, full | {"iridescenceIor": 2.2, "iridescenceThicknessMaximum": 260}, solid),
    ]
    for place, (color, metallic, roughness, fields, others) in enumerate(cases):
        material = glb.material(color, metallic, roughness,
                                extensions={"KHR_materials_iridescence": fields, **others})
        glb.node(glb.mesh(ball, material), translation=[place % 4 * 1.1 - 1.65, 0.55 - place // 4 * 1.1, 0])
    glb.light("directional", (-1, 1, 1.5), intensity=3.0)
    glb.camera((0, 0, 8.6))
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


SCENES = [arm, spheres, normal_map, textures, alpha, lights, vertex_colors, emissive, unlit, specular_ior, glass,
          dispersion, anisotropy, clearcoat, sheen, iridescence, specular_glossiness, rough_diffuse, translucent,
          subsurface, two_sided, lines_points, occlusion, tiny, huge]

if __name__ == "__main__":
    save_scenes(SCENES, Path(__file__).parent / "scenes")
