"""What the environment's texels are stored in."""

from __future__ import annotations

from functools import partial

import moderngl
import numpy as np

from viewer.gpu.context import Context

from .light import NAMES, radiance, seen, sphere_points
from .piece import SHADERS, Case, Kernel, Piece, Variant, relative

# Name, OpenGL's internal format, bytes a texel
_FORMATS = (
    ("float, 32 bits a channel", 0x8815, 12),
    ("half, 16 bits a channel", 0x881B, 6),
    ("shared exponent, 9 + 5 bits", 0x8C3D, 4),
    ("small floats, 11, 11 and 10 bits", 0x8C3A, 4),
)


def storage_piece() -> Piece:
    """Directions at random places between texels; p is a direction."""
    directions = sphere_points(4096).reshape(64, 64, 3)
    directions = directions[np.abs(directions[..., 1]).max(axis=1) < 0.999]
    parameters = np.concatenate([directions, np.zeros((*directions.shape[:2], 1))], axis=2).astype(np.float32)
    cases = tuple(Case(parameters, relative(seen(name, parameters[..., :3].astype(np.float64)))) for name in NAMES)
    variants = []
    for words, internal_format, size in _FORMATS:
        kernels = tuple(Kernel(SHADERS / "curves.glsl", "textureLod(u_map, equirect_uv_by_functions(p.xyz), 0.0)",
                               {"u_map": partial(_environment_texture, name, internal_format)}) for name in NAMES)
        variants.append(Variant(words, kernels, size=size * radiance(NAMES[0])[..., 0].size,
                                is_default=internal_format == 0x881B))
    return Piece("storage", "Texels of the environment", f"directions all around, in {' and '.join(NAMES)}",
                 "shares of the radiance", "the map in float64", cases, tuple(variants),
                 "Half floats hold all that a texture unit's own interpolation leaves exact. A shared exponent would "
                 "save a third of the memory, and be packed at every start.")


def _environment_texture(name: str, internal_format: int, context: Context) -> moderngl.Texture:
    pixels = radiance(name)
    height, width = pixels.shape[:2]
    texture = context.gl.texture((width, height), 3, np.ascontiguousarray(pixels), dtype="f4", alignment=1,
                                 internal_format=internal_format)
    texture.filter = (moderngl.LINEAR, moderngl.LINEAR)
    texture.repeat_y = False
    return texture
