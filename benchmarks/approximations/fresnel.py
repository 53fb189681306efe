"""Schlick's reflectance against Fresnel's equations, for dielectrics and for metals."""

from __future__ import annotations

import numpy as np

from viewer.measure.check import reference

from .piece import SHADERS, Case, Kernel, Piece, Variant, absolute, grid

_FILE = SHADERS / "fresnel.glsl"
_SWITCHES = {"SHOW_DIFFUSE": 1, "SHOW_SPECULAR": 1, "SHOW_MULTISCATTER": 1, "MULTISCATTER": 1, "FRESNEL": 0,
             "DIFFUSE_ROUGH": 0, "IRIDESCENT": 0}
# n, k at 650, 550 and 450 nm (Johnson & Christy 1972; aluminium: Rakic 1995): silver, gold, copper, iron, titanium, Al.
_METALS = np.array([
    (0.052, 4.41), (0.060, 3.59), (0.040, 2.65), (0.166, 3.15), (0.422, 2.34), (1.381, 1.92), (0.214, 3.67),
    (0.904, 2.59), (1.249, 2.48), (2.89, 3.37), (2.95, 2.93), (2.66, 2.72), (2.70, 3.70), (2.44, 3.30), (1.98, 2.72),
    (1.49, 7.82), (0.96, 6.69), (0.62, 5.47),
])
_F82 = 1 / 7


def dielectric_piece() -> Piece:
    """p is mu, index, f0."""
    parameters = grid(np.linspace(0, 1, 101), np.linspace(1.05, 2.5, 59))
    mu, ior = parameters[..., 0].astype(np.float64), parameters[..., 1].astype(np.float64)
    parameters[..., 2] = ((ior - 1) / (ior + 1)) ** 2
    ways = (
        ("Schlick", "interface_fresnel(p.x, p.y, p.z)", 0, "Schlick 1994; glTF 2.0"),
        ("Schlick by pow()", "f_schlick_by_pow(vec3(p.z), p.x)", 0, "the same formula"),
        ("spherical Gaussian", "f_schlick_gaussian(vec3(p.z), p.x)", 0, "Lagarde 2012"),
        ("exact", "interface_fresnel(p.x, p.y, p.z)", 1, "Fresnel's equations; --set fresnel=exact"),
    )
    return Piece("fresnel-dielectric", "Fresnel reflectance of dielectrics", "mu from 0 to 1, index from 1.05 to 2.5",
                 "reflectance", "Fresnel's equations in long double",
                 (Case(parameters, absolute(reference.f_dielectric(mu, ior)[..., None])),),
                 tuple(_variant(name, call, source, exact) for name, call, exact, source in ways),
                 "glTF 2.0 prescribes Schlick's curve, and the table of the albedo holds it; glass and --set "
                 "fresnel=exact have Fresnel's.")


def metal_piece() -> Piece:
    """p is mu, n, k; q is f0 and F82's tint, which no file of glTF holds."""
    mu, (n, k) = np.linspace(0, 1, 101)[:, None], _METALS.T
    truth, f0, at_82 = (reference.f_conductor(angle, n, k) for angle in (mu, 1.0, _F82))
    parameters = np.zeros((*truth.shape, 8), np.float32)
    tint = at_82 / reference.f_schlick(f0, 1.0, _F82)
    for column, values in enumerate((mu, n, k, 0, f0, tint)):
        parameters[..., column] = values
    ways = (
        ("Schlick", "f_schlick(vec3(q.x), vec3(1.0), p.x)", "Schlick 1994; glTF 2.0"),
        ("F82-tint", "f_f82_tint(vec3(q.x), vec3(q.y), p.x)", "Kutz 2021; needs a second colour"),
        ("exact", "f_conductor(p.x, vec3(p.y), vec3(p.z))", "Fresnel's equations; needs n and k"),
    )
    return Piece("fresnel-metal", "Fresnel reflectance of metals", "mu from 0 to 1, six metals in red, green and blue",
                 "reflectance", "Fresnel's equations in long double", (Case(parameters, absolute(truth[..., None])),),
                 tuple(_variant(name, call, source, 0) for name, call, source in ways),
                 "Files have one colour for a metal; the better curves need two.")


def _variant(name: str, call: str, source: str, exact: int) -> Variant:
    kernel = Kernel(_FILE, f"vec4({call}, 0.0)", defines=_SWITCHES | {"FRESNEL": exact})
    return Variant(name, (kernel,), source, is_default=name == "Schlick")
