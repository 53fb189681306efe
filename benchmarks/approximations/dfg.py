"""The directional albedo of GGX: the table at several sizes, and the fits that need none."""

from __future__ import annotations

import time
from functools import partial

import moderngl
import numpy as np

from viewer.bake.dfg import SIZE, albedo_table, dfg_table, directional_albedo
from viewer.gpu.context import Context
from viewer.gpu.float_texture import float_texture

from .piece import SHADERS, Case, Kernel, Piece, Variant, grid

F0 = np.array([0.04, 1.0])
_FITS = (
    ("fit, Karis 2014", "dfg_karis(p.x, p.y)", "Physically Based Shading on Mobile"),
    ("fit, Lazarov 2013", "dfg_lazarov(p.x, p.y)", "to GGX by Narkowicz 2014"),
    ("fit, Narkowicz 2014", "dfg_narkowicz(p.x, p.y)", "Analytical DFG Term for IBL"),
    ("fit, MaterialX", "dfg_materialx(p.x, p.y * p.y)", "rational, in MaterialX 1.38"),
)


def dfg_piece(sizes: tuple[int, ...] = (8, 16, 32, SIZE, 128)) -> Piece:
    """Over cosines and roughnesses that lie between the tables' own; errors of f0 a + b at both F0."""
    NoV, roughness = np.linspace(0.052, 0.993, 37), np.linspace(0.052, 0.993, 29)
    rows = [directional_albedo("ggx", "smith", NoV, float(r * r), 64) for r in roughness.astype(np.float32)]
    truth = np.stack(rows, axis=1)
    variants = [_table(size, dtype) for size in sizes for dtype in (np.float16, np.float32)]
    variants += [Variant(name, (Kernel(SHADERS / "dfg.glsl", f"vec4({call}, 0.0, 0.0)"),), source)
                 for name, call, source in _FITS]
    case = Case(grid(NoV, roughness), lambda found: _albedo(found[..., :2]) - _albedo(truth))
    return Piece("dfg", "Directional albedo of GGX", "NoV and perceptual roughness from 0.05 to 1, f0 0.04 and 1",
                 "albedo", "quadrature in float64", (case,), tuple(variants),
                 "A look-up costs the same whatever the size; 64 x 64 is the first whose largest error no 8-bit "
                 "picture shows. Floats, for multiple scattering divides by what is missing to 1.")


def _albedo(ab: np.ndarray) -> np.ndarray:
    return ab[..., :1].astype(np.float64) * F0 + ab[..., 1:]


def _table(size: int, dtype: type) -> Variant:
    started = time.process_time()
    pixels = albedo_table("ggx", "smith", size)
    bake = time.process_time() - started
    is_default = size == SIZE and dtype is np.float32
    name = f"table {size} x {size}, {'half' if dtype is np.float16 else 'float'}"
    if is_default:
        kernel = ("light/dfg.glsl", "vec4(dfg_albedo(u_dfg, p.x, p.y), 0.0, 0.0)")
        pixels = dfg_table()
    else:
        kernel = (SHADERS / "dfg.glsl", f"vec4(dfg_albedo_of_size(u_dfg, p.x, p.y, {size:.1f}), 0.0, 0.0)")
    upload = partial(_upload, pixels.astype(dtype))
    return Variant(name, (Kernel(*kernel, {"u_dfg": upload}),), "Karis 2013, v = sqrt(NoV)",
                   size * size * 4 * np.dtype(dtype).itemsize, bake, is_default)


def _upload(pixels: np.ndarray, context: Context) -> moderngl.Texture:
    return float_texture(context.gl, pixels)
