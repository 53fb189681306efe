"""Makes those of `scenes/*.glb` that show opaque materials: python assets/make_material_scenes.py"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from glb import Glb, plate, save_scenes, sphere, without


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


SCENES = [emissive, unlit, specular_ior, anisotropy, specular_glossiness, rough_diffuse, clearcoat, sheen,
          iridescence]

if __name__ == "__main__":
    save_scenes(SCENES, Path(__file__).parent / "scenes")
