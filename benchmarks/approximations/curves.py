"""Small functions: sRGB, the way from a direction to the map, and GGX's D and V."""

from __future__ import annotations

import numpy as np

from viewer.measure.check import reference

from .piece import SHADERS, Case, Kernel, Piece, Variant, grid, relative

_FILE = SHADERS / "curves.glsl"
_MAP_WIDTH = 1024


def srgb_piece() -> Piece:
    """p is a colour."""
    light = np.linspace(0, 1, 128 * 128).astype(np.float32).reshape(128, 128)
    parameters = np.stack([light] * 4, axis=-1)
    truth = 255 * reference.srgb_from_linear(light.astype(np.float64))[..., None]
    return Piece("srgb", "Linear light to sRGB", "light from 0 to 1", "code values of 255", "IEC 61966-2-1 in float64",
                 (Case(parameters, lambda found: 255.0 * found[..., :1] - truth),), _variants(
        ("piecewise", "vec4(srgb_from_linear(p.rgb), 1.0)", "IEC 61966-2-1"),
        ("gamma 2.2", "vec4(srgb_by_gamma(p.rgb), 1.0)", ""),
        ("square roots", "vec4(srgb_by_roots(p.rgb), 1.0)", "Taylor 2012"),
    ), "Once a pixel, and code values must come out as they went in.")


def equirect_piece() -> Piece:
    """p is a direction."""
    theta, phi = np.linspace(0.002, np.pi - 0.002, 151)[:, None], np.linspace(-3.14, 3.14, 203)
    parameters = np.zeros((151, 203, 4), np.float32)
    for axis, values in enumerate((np.sin(theta) * np.cos(phi), np.cos(theta), np.sin(theta) * np.sin(phi))):
        parameters[..., axis] = values
    d = parameters[..., :3].astype(np.float64)
    across = np.hypot(d[..., 0], d[..., 2])
    truth = np.stack([0.5 + np.arctan2(d[..., 2], d[..., 0]) / (2 * np.pi), np.arctan2(across, d[..., 1]) / np.pi], -1)

    def error(found: np.ndarray) -> np.ndarray:
        off = (found[..., :2] - truth) * _MAP_WIDTH
        return np.hypot(off[..., 0] * across, off[..., 1] / 2)

    return Piece("direction-to-map", "A direction's place on the map", "the sphere", f"texels of {_MAP_WIDTH} around",
                 "float64", (Case(parameters, error),), _variants(
        ("polynomials", "vec4(equirect_uv(p.xyz), 0.0, 0.0)", "Abramowitz & Stegun 4.4.45"),
        ("atan() and acos()", "vec4(equirect_uv_by_functions(p.xyz), 0.0, 0.0)", "the driver's own"),
    ), "A fiftieth of a texel is less than single floats and texture units make of it.")


def distribution_piece() -> Piece:
    """p is NoH, |n x h|^2 and alpha, at angles as far as the lobe has a thousandth of its peak."""
    alpha = np.geomspace(MIN_ALPHA, 1, 61)
    share = np.linspace(0, 1, 101)[:, None]
    theta = share * np.minimum(np.arctan(alpha * np.sqrt(30)), 1.5)
    parameters = np.zeros((*theta.shape, 4), np.float32)
    for axis, values in enumerate((np.cos(theta), np.sin(theta) ** 2, alpha)):
        parameters[..., axis] = values
    truth = reference.d_ggx(theta, np.float32(alpha).astype(np.float64))[..., None]
    over = f"alpha from {MIN_ALPHA:g} to 1, the lobe down to 1/1000"
    return Piece("ggx-distribution", "GGX's D in single floats", over,
                 "shares of D", "Walter 2007, eq. 33 in float64", (Case(parameters, relative(truth)),), _variants(
        ("by the cross product", "vec4(d_ggx(p.x, p.y, p.z))", "Lagrange's identity"),
        ("textbook", "vec4(d_ggx_textbook(p.x, p.z))", "1 + NoH^2 (alpha^2 - 1)"),
    ), "It costs nothing, and path tracing goes down to alpha 1e-4, where the textbook's has no digits left.")


MIN_ALPHA = 0.045**2
"""The real-time roughness floor, squared."""


def masking_piece() -> Piece:
    """p is NoV, NoL, alpha."""
    alpha = np.linspace(MIN_ALPHA, 1, 41)
    cosines = np.linspace(0.05, 1, 20)
    NoV, NoL = (axis.ravel()[:, None] for axis in np.meshgrid(cosines, cosines))
    parameters = grid(np.zeros(len(NoV)), alpha)
    parameters[..., 0], parameters[..., 1], parameters[..., 2] = NoV, NoL, alpha
    exact = parameters.astype(np.float64)
    truth = reference.v_smith_ggx(exact[..., 0], exact[..., 1], exact[..., 2])[..., None]
    over = "NoV and NoL from 0.05 to 1, alpha from 0.002 to 1"
    return Piece("ggx-masking", "Smith's masking of GGX, V", over, "shares of V",
                 "Heitz 2014, eq. 99 in float64", (Case(parameters, relative(truth)),), _variants(
        ("height-correlated", "vec4(v_smith_ggx(p.x, p.y, p.z))", "Heitz 2014"),
        ("Hammon's fit", "vec4(v_hammon_ggx(p.x, p.y, p.z))", "Hammon 2017"),
        ("separable", "vec4(v_smith_separable_ggx(p.x, p.y, p.z))", "--set masking=smith-separable"),
    ), "Exact for two square roots.")


def _variants(*ways: tuple[str, str, str]) -> tuple[Variant, ...]:
    """The first is the renderer's."""
    return tuple(Variant(name, (Kernel(_FILE, call),), source, is_default=k == 0)
                 for k, (name, call, source) in enumerate(ways))
