"""Pictures of extreme scenes: none may contain NaN or infinity, and where the right picture is known, it must be it."""

from __future__ import annotations

import base64
import json
import tempfile
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

from ...image.image import Image
from ...raster.renderer import Renderer
from ...scene.camera import Camera
from ...scene.environment import Environment
from ...scene.equirect import sphere_integral, texel_directions
from ...scene.light import Light
from ...scene.load import load_scene
from ...scene.material import Material
from ...scene.scene import Scene
from ...settings import Settings
from ..compare.difference import compare
from .checks import Check
from .scenes import constant, placed, plate, scene, sphere

SIZE = (64, 64)
LAMBERTIAN = Material(metallic=0.0, specular=0.0)
KEY = Light.from_angles(0.7, 0.6, 3.0)
_MATERIALS = {
    "roughness 0": Material(perceptual_roughness=0.0),
    "roughness 1": Material(perceptual_roughness=1.0),
    "IOR 1": Material(metallic=0.0, perceptual_roughness=0.3, ior=1.0),
    "IOR 1.0001": Material(metallic=0.0, perceptual_roughness=0.3, ior=1.0001),
    "IOR 100": Material(metallic=0.0, perceptual_roughness=0.3, ior=100.0),
    "f0 0": Material(metallic=1.0, perceptual_roughness=0.3, base_color=(0, 0, 0, 1)),
    "f0 1": Material(metallic=1.0, perceptual_roughness=0.3),
    "glass of IOR 1, opaque in red and clear in green": Material(
        metallic=0.0, perceptual_roughness=0.0, ior=1.0, transmission=1.0, thickness=1e6, attenuation_distance=1e-6,
        attenuation_color=(0.0, 1.0, 0.5)),
    "thin-walled glass of IOR 100": Material(metallic=0.0, perceptual_roughness=1.0, ior=100.0, transmission=1.0),
}
_FRONT, _BACK = (replace(LAMBERTIAN, base_color=(*color, 1.0)) for color in ((0.0, 1.0, 0.0), (1.0, 0.0, 0.0)))


def check_extremes(renderer: Renderer) -> Iterator[Check]:
    """A row for every picture."""
    yield from _check_materials(renderer)
    yield from _check_lights(renderer)
    yield from _check_places(renderer)
    yield from _check_depth(renderer)
    yield from _check_broken_geometry(renderer)


def not_finite(case: str, image: Image) -> Check:
    """How many numbers of the picture are NaN or infinite; none may be."""
    return Check("no NaN, no Inf", case, int((~np.isfinite(image.linear)).sum()), 0)


def _picture(renderer: Renderer, shown: Scene, camera: Camera, **settings: object) -> Image:
    return renderer.render(shown, camera, Settings.of(**{"background": "none", "antialias": "none"} | settings), SIZE)


def _framed(shown: Scene) -> Camera:
    return Camera.framing(shown.center, shown.radius, 1.0)


def _check_materials(renderer: Renderer) -> Iterator[Check]:
    for name, material in _MATERIALS.items():
        for fresnel in ("schlick", "exact"):
            ball = scene([sphere()], [material], lights=[KEY], environment=constant())
            yield not_finite(f"{name}, {fresnel}", _picture(renderer, ball, _framed(ball), fresnel=fresnel))
    for name in ("roughness 0", "roughness 1", "f0 0", "IOR 1"):
        # One light almost along the plate, the eye a hundredth of a degree above it.
        floor = scene([plate(half=100.0)], [_MATERIALS[name]], environment=constant(),
                      lights=[Light("directional", direction=(-1.0, 0.0, -1e-5))])
        camera = Camera.look_at((0, -1, 2e-4), (0, 1, 0), up=(0, 0, 1))
        yield not_finite(f"grazing view and light, {name}", _picture(renderer, floor, camera))


def _check_lights(renderer: Renderer) -> Iterator[Check]:
    sun, total = _sun()
    for name, material in (("white plaster", LAMBERTIAN), ("metal", Material(perceptual_roughness=0.3))):
        lit = scene([plate()], [material], environment=sun)
        picture = _picture(renderer, lit, Camera.look_at((0, 0, 2), (0, 0, 0)), shadows="off")
        yield not_finite(f"a sun of 1e6 in an environment of 1e-3, {name}", picture)
        if material is LAMBERTIAN:
            error = abs(float(picture.linear[32, 32, 0]) / total - 1)
            note = f"radiance {total:.4g}"
            yield Check("light kept", "a sun of 1e6 in an environment of 1e-3", error, 0.01, note=note)
    ball = scene([sphere()], [Material(metallic=0.5, perceptual_roughness=0.4)], lights=[replace(KEY, intensity=1.0)])
    usual = _picture(renderer, ball, _framed(ball)).linear[..., :3].astype(np.float64)
    for intensity in (1e-12, 1e12):
        picture = _picture(renderer, replace(ball, lights=(replace(KEY, intensity=intensity),)), _framed(ball))
        yield not_finite(f"light of intensity {intensity:g}", picture)
        error = np.abs(picture.linear[..., :3] / intensity - usual).max() / usual.max()
        yield Check("linear in light", f"intensity {intensity:g}", float(error), 1e-6)


def _sun() -> tuple[Environment, float]:
    """Four texels of radiance 1e6 towards +Z in a map of 1e-3, and E / pi of a plate that faces them, in float64."""
    height = 64
    radiance = np.full((height, 2 * height, 3), 1e-3, np.float32)
    towards = texel_directions(height, 2 * height)
    brightest = np.unravel_index(np.argsort(towards[..., 2], axis=None)[-4:], towards.shape[:2])
    radiance[brightest] = 1e6
    cosine = np.maximum(towards[..., 2], 0)[..., None]
    return Environment("sun", radiance), float(sphere_integral(radiance * cosine)[0] / np.pi)


def _check_places(renderer: Renderer) -> Iterator[Check]:
    materials = [Material(metallic=0.5, perceptual_roughness=0.4, base_color=(0.9, 0.4, 0.1, 1.0)), LAMBERTIAN]

    def view(scale: float, offset: float) -> Image:
        center = np.array([offset, -offset, offset])
        light = Light("point", intensity=20 * scale**2, position=tuple(center + scale * np.array([2.0, 2, 3])))
        things = scene([sphere(0), plate(1, 3.0)], materials, environment=constant(0.5), lights=[light, KEY],
                       transforms=[placed(center, scale), placed(center - [0, 0, scale], scale)])
        camera = Camera.look_at(center + scale * np.array([1.0, 0.5, 5]), center)
        return renderer.render(things, camera, Settings.of(), SIZE)

    usual = view(1.0, 0.0)
    for scale in (1e-6, 1e-3, 1e3, 1e6):
        yield from _same_picture(f"scale {scale:g}", usual, view(scale, 0.0))
    yield from _same_picture("a million units from the origin", usual, view(1.0, 1e6))


def _same_picture(case: str, usual: Image, picture: Image) -> Iterator[Check]:
    yield not_finite(case, picture)
    yield Check("same picture", case, compare(usual, picture).flip, 1e-3, note="mean FLIP")


def _check_depth(renderer: Renderer) -> Iterator[Check]:
    """Which of two plates is in front: the green one is, the red one is behind it."""
    for case, distance, gap, near in (("coplanar but for 1e-3 of a distance of 1000", 1e3, 1.0, ()),
                                      ("coplanar but for 1e-4 of a distance of 1000", 1e3, 0.1, ()),
                                      # 24 bits of depth, z^2 / (near 2^24) apart, tell 0.6 % of the distance here.
                                      ("2e-2 of the distance apart, at a depth range of 100000:1", 1e4, 200.0, (0.1,))):
        transforms = [placed((0, 0, -distance), distance), placed((0, 0, -distance - gap), distance)]
        transforms += [placed((0.9 * d * np.tan(np.pi / 8), 0, -d), 0.02 * d) for d in near]
        # Seen at a slant, and the back one drawn last, depth alone decides.
        turn = np.eye(4)
        turn[:3, :3] = Camera.orbit((0, 0, 0), 1.0, 0.0, 0.5).pose[:3, :3]
        transforms[:2] = [t @ turn for t in transforms[:2]]
        meshes = [plate(0), plate(1), *(plate(0) for _ in near)]
        plates = scene(meshes, [_FRONT, _BACK], transforms=transforms, environment=constant())
        picture = _picture(renderer, plates, Camera.look_at((0, 0, 0), (0, 0, -1)))
        yield not_finite(case, picture)
        wrong = int((picture.linear[..., 0] > picture.linear[..., 1]).sum())
        covered = int((picture.linear[..., 3] > 0).sum())
        share = wrong / covered if covered else 1.0
        yield Check("right one in front", case, share, 0.0, note="share of pixels that show the one behind")


def _check_broken_geometry(renderer: Renderer) -> Iterator[Check]:
    nan = np.nan
    square = [[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]]
    up, uv = [[0.0, 0.0, 1.0]] * 4, [[0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0]]
    cases = {
        "degenerate triangles": ([[0, 0, 0], [1, 0, 0], [2, 0, 0], [0, 0, 0], *square], up + up, uv + uv,
                                 [0, 1, 2, 0, 0, 0, 1, 3, 3, 4, 5, 6, 4, 6, 7]),
        "zero normals": (square, [[0.0, 0.0, 0.0]] * 4, uv, [0, 1, 2, 0, 2, 3]),
        "NaN normals": (square, [[nan, 0.0, 1.0], *up[:3]], uv, [0, 1, 2, 0, 2, 3]),
        "normals that cancel between vertices": (square, [*up[:2], [0.0, 0.0, -1.0], [0.0, 0.0, -1.0]], uv,
                                                 [0, 1, 2, 0, 2, 3]),
        "UVs without area": (square, up, [[0.5, 0.5]] * 4, [0, 1, 2, 0, 2, 3]),
    }
    for case, (positions, normals, uvs, indices) in cases.items():
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "broken.gltf"
            file.write_text(json.dumps(_gltf(positions, normals, uvs, indices)))
            model = load_scene(file).relit(environment=constant(), lights=(KEY,))
            picture = _picture(renderer, model, _framed(model))
        yield not_finite(case, picture)


def _gltf(positions: list, normals: list, uvs: list, indices: list) -> dict[str, object]:
    """A glTF file with a normal map, so that the repairs of the reader are checked too."""
    parts = [np.array(p, np.float32) for p in (positions, normals, uvs)] + [np.array(indices, np.uint32)]
    data, views = b"", []
    for part in parts:
        views.append({"buffer": 0, "byteOffset": len(data), "byteLength": part.nbytes})
        data += part.tobytes()
    kinds = [("VEC3", 5126), ("VEC3", 5126), ("VEC2", 5126), ("SCALAR", 5125)]
    accessors = [{"bufferView": k, "componentType": component, "count": len(part), "type": kind}
                 for k, (part, (kind, component)) in enumerate(zip(parts, kinds))]
    accessors[0] |= {"min": parts[0].min(axis=0).tolist(), "max": parts[0].max(axis=0).tolist()}
    bumps = np.tile(np.array([[[128, 128, 255], [200, 128, 230]]], np.uint8), (2, 1, 1))
    normal_map = base64.b64encode(Image.from_srgb(bumps)._repr_png_()).decode()
    return {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "images": [{"uri": f"data:image/png;base64,{normal_map}"}], "textures": [{"source": 0}],
        "materials": [{"normalTexture": {"index": 0}, "doubleSided": True}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "NORMAL": 1, "TEXCOORD_0": 2}, "indices": 3,
                                    "material": 0}]}],
        "accessors": accessors, "bufferViews": views,
        "buffers": [{"byteLength": len(data),
                     "uri": "data:application/octet-stream;base64," + base64.b64encode(data).decode()}],
    }
