"""A scene of ours as one of Mitsuba 3's, for renders to hold ours against. Needs the extra `truth`.

What both can say exactly: Lambertian surfaces (specular 0), metals of F0 = 1 or a tint of it (F = F0 at every angle,
so only F0 = 1 is Schlick's), glass, emission by factor, environments, point and directional lights. Everything else
becomes Mitsuba's `principled`, textures included: close, not equal, and good for speed alone.
"""

from __future__ import annotations

import glob
import importlib.util
import os
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from viewer.scene.camera import Camera
from viewer.scene.color import srgb_to_linear
from viewer.scene.light import Light
from viewer.scene.material import Material, Texture
from viewer.scene.mesh import Mesh
from viewer.scene.scene import Scene

DEPTH = 33
"""Of Mitsuba's longest path, in segments: 32 bounces of ours."""

_LLVM = ("/usr/lib/*/libLLVM.so.2*", "/usr/lib/*/libLLVM.so.19*", "/usr/lib/llvm-*/lib/libLLVM.so*")
# LLVM 15 and 16 end the process on some of Mitsuba's code ("Cannot select: fminimum").


def is_installed() -> bool:
    """Whether Mitsuba is there, and a GPU for its CUDA backend or an LLVM that it works with."""
    return importlib.util.find_spec("mitsuba") is not None and (_has_cuda() or bool(_llvm()))


def mitsuba() -> Any:
    """The module, set to its CUDA variant where there is a GPU for it, since ours draws there too; else to LLVM's."""
    os.environ.setdefault("DRJIT_LIBLLVM_PATH", _llvm())
    import mitsuba as mi

    mi.set_variant("cuda_ad_rgb" if _has_cuda() else "llvm_ad_rgb")
    return mi


@cache
def _has_cuda() -> bool:
    import drjit

    return bool(drjit.has_backend(drjit.JitBackend.CUDA))


def convert(scene: Scene, camera: Camera, size: tuple[int, int], depth: int = DEPTH) -> Any:
    """A scene for `render`. Raises ValueError for what has no counterpart: spots, orthographic cameras."""
    mi = mitsuba()
    parts: dict[str, Any] = {"type": "scene", "integrator": {"type": "path", "max_depth": depth, "rr_depth": 4},
                             "sensor": mitsuba_sensor(mi, camera, size)}
    if scene.environment is not None:
        turn = 90 + np.degrees(scene.environment.rotation)
        parts["environment"] = {"type": "envmap", "bitmap": mi.Bitmap(for_mitsuba(scene.environment.radiance)),
                                "scale": scene.environment.intensity,
                                "to_world": mi.ScalarTransform4f().rotate([0, 1, 0], turn)}
    for k, light in enumerate(scene.lights):
        parts[f"light{k}"] = _light(light)
    for k, instance in enumerate(scene.instances):
        mesh = scene.meshes[instance.mesh]
        if mesh.topology == "triangles":
            parts[f"mesh{k}"] = mitsuba_mesh(mi, mesh, scene.materials[mesh.material], instance.transform)
    return mi.load_dict(parts)


def for_mitsuba(radiance: np.ndarray) -> np.ndarray:
    """A map (H, W, 3) that Mitsuba reads as we read `radiance`, (2 H + 1, W, 3).

    To Mitsuba the first row is the pole itself and the last the other; to us, as to the texture units of a GPU, rows
    are texels, half a row away from the poles. Every kink of our bilinear filter is a row of this map.
    """
    padded = np.concatenate([radiance[:1], radiance, radiance[-1:]])
    out = np.empty((2 * len(radiance) + 1, *radiance.shape[1:]), np.float32)
    out[1::2] = radiance
    out[::2] = (padded[:-1] + padded[1:]) / 2
    return out


def from_mitsuba(radiance: np.ndarray, rows: int = 4) -> np.ndarray:
    """The reverse: what Mitsuba sees in `radiance`, (rows (H - 1), W, 3), but for the tips of its tent filter, which
    are cut by an eighth of a row each way."""
    parts = (np.arange(rows, dtype=np.float32) + 0.5)[:, None, None] / rows
    between = (1 - parts) * radiance[:-1, None] + parts * radiance[1:, None]  # (H - 1, rows, W, 3)
    return between.reshape(-1, *radiance.shape[1:]).astype(np.float32)


def render(scene: Any, spp: int, seed: int = 0) -> np.ndarray:
    """Linear Rec. 709 radiance, (H, W, 3) float32, row 0 the top."""
    return np.array(mitsuba().render(scene, spp=spp, seed=seed))[..., :3]


def _llvm() -> str:
    given = os.environ.get("DRJIT_LIBLLVM_PATH")
    found = [given] if given else [path for pattern in _LLVM for path in sorted(glob.glob(pattern))]
    return next((path for path in found if Path(path).exists()), "")


def mitsuba_sensor(mi: Any, camera: Camera, size: tuple[int, int]) -> dict[str, Any]:
    """The camera, with a box filter. Raises ValueError for an orthographic one."""
    if camera.height is not None:
        raise ValueError("an orthographic camera")
    pose = camera.pose @ np.diag([-1.0, 1.0, -1.0, 1.0])  # Mitsuba looks along +Z, with +X to the left
    film = {"type": "hdrfilm", "width": size[0], "height": size[1], "rfilter": {"type": "box"}, "pixel_format": "rgb"}
    return {"type": "perspective", "fov": float(np.degrees(camera.fov_y)), "fov_axis": "y", "near_clip": 1e-3,
            "far_clip": 1e5, "to_world": mi.ScalarTransform4f(pose), "film": film,
            "sampler": {"type": "independent"}}


def _light(light: Light) -> dict[str, Any]:
    power = {"type": "rgb", "value": [light.intensity * c for c in light.color]}
    if light.kind == "point":
        return {"type": "point", "position": list(light.position), "intensity": power}
    if light.kind == "directional":
        return {"type": "directional", "direction": list(light.direction), "irradiance": power}
    raise ValueError(f"a light of kind {light.kind}")


def mitsuba_mesh(mi: Any, mesh: Mesh, material: Material, transform: np.ndarray,
                 inside: dict[str, Any] | None = None) -> Any:
    """A mesh in its place, full of the medium `inside`."""
    triangles = np.arange(len(mesh.positions)) if mesh.indices is None else mesh.indices
    positions = mesh.positions @ transform[:3, :3].T + transform[:3, 3]
    mirrored = np.linalg.det(transform[:3, :3]) < 0
    triangles = triangles.reshape(-1, 3)[:, ::-1 if mirrored else 1]
    properties = mi.Properties()
    properties["bsdf"] = mi.load_dict(_bsdf(mi, material))
    if inside is not None:
        properties["interior"] = mi.load_dict(inside)
    if max(material.emissive) > 0:
        properties["emitter"] = mi.load_dict({"type": "area", "radiance": _color(
            mi, material.emissive, material.emissive_texture)})
    uvs = mesh.uvs[0] if mesh.uvs else None
    out = mi.Mesh(mesh.name or "mesh", len(positions), len(triangles), has_vertex_normals=mesh.normals is not None,
                  has_vertex_texcoords=uvs is not None, props=properties)
    parameters = mi.traverse(out)
    parameters["vertex_positions"] = np.ascontiguousarray(positions, np.float32).ravel()
    parameters["faces"] = np.ascontiguousarray(triangles, np.uint32).ravel()
    if mesh.normals is not None:
        normals = mesh.normals @ np.linalg.inv(transform[:3, :3])
        normals /= np.linalg.norm(normals, axis=1, keepdims=True)
        parameters["vertex_normals"] = np.ascontiguousarray(normals, np.float32).ravel()
    if uvs is not None:
        parameters["vertex_texcoords"] = np.ascontiguousarray(np.stack([uvs[:, 0], 1 - uvs[:, 1]], 1),
                                                              np.float32).ravel()
    parameters.update()
    return out


def _bsdf(mi: Any, material: Material) -> dict[str, Any]:
    alpha = max(material.perceptual_roughness**2, 1e-4)
    rough = {"distribution": "ggx", "alpha": alpha, "sample_visible": True}
    color = _color(mi, material.base_color[:3], material.base_color_texture)
    if getattr(material, "transmission", 0.0) == 1.0 and material.ior == 1.0:
        return {"type": "null"}
    if getattr(material, "transmission", 0.0) == 1.0:
        kind = {"type": "dielectric"} if material.perceptual_roughness == 0 else {"type": "roughdielectric", **rough}
        return kind | {"int_ior": material.ior, "ext_ior": 1.0}
    plain = material.metallic_roughness_texture is None and material.normal_texture is None
    if plain and material.metallic == 0 and material.specular == 0:
        return {"type": "twosided", "bsdf": {"type": "diffuse", "reflectance": color}}
    if plain and material.metallic == 1:
        metal = {"type": "roughconductor", "material": "none", "eta": 0.0, "k": 1.0, "specular_reflectance": color}
        return {"type": "twosided", "bsdf": metal | rough}
    data = material.metallic_roughness_texture
    bsdf = {"type": "principled", "specular": 0.5 * material.specular, "base_color": color,
            "roughness": _data(mi, data, material.perceptual_roughness, "G"),
            "metallic": _data(mi, data, material.metallic, "B")}
    if material.normal_texture is not None:
        texels = material.normal_texture.image.decode("RGB").astype(np.float32) / 255
        bsdf = {"type": "normalmap", "normalmap": _bitmap(mi, texels), "bsdf": bsdf}
    return {"type": "twosided", "bsdf": bsdf}


def _color(mi: Any, factor: tuple[float, ...], texture: Texture | None) -> dict[str, Any]:
    if texture is None:
        return {"type": "rgb", "value": list(factor)}
    texels = srgb_to_linear(texture.image.decode("RGB") / 255) * np.asarray(factor)
    return _bitmap(mi, texels)


def _data(mi: Any, texture: Texture | None, factor: float, channel: str) -> float | dict[str, Any]:
    return factor if texture is None else _bitmap(mi, texture.image.decode(channel) / 255 * factor)


def _bitmap(mi: Any, texels: np.ndarray) -> dict[str, Any]:
    return {"type": "bitmap", "bitmap": mi.Bitmap(np.ascontiguousarray(texels, np.float32)), "raw": True,
            "filter_type": "bilinear"}
