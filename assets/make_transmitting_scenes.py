"""Makes those of `scenes/*.glb` that let light through: python assets/make_transmitting_scenes.py"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from glb import Glb, lathe, plate, save_scenes, sphere, without


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


SCENES = [glass, dispersion, translucent, subsurface]

if __name__ == "__main__":
    save_scenes(SCENES, Path(__file__).parent / "scenes")
