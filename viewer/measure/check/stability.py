"""float32 on the GPU against float64: relative error, and units in the last place.

If a bound is wider than a few units in the last place, the row also has the best that float32 could do: the error of
an exact function of rounded arguments (its condition).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

import numpy as np

from ...gpu.call import call_glsl
from . import media_reference, reference
from .checks import Check

TINY = float(np.finfo(np.float32).tiny)
HALF_ULP = 2.0**-24

ALPHA = np.unique(np.concatenate([[1e-3, 0.01, 0.1, 0.5, 1.0], np.geomspace(1e-3, 1, 40)]))
COSINE = np.unique(np.concatenate([[1e-4, 1e-3, 0.1, 0.5, 1.0], np.geomspace(1e-4, 1, 40), np.linspace(0.02, 1, 40)]))
BEYOND_ALPHA = np.array([1e-4, 3e-4])
BEYOND_COSINE = np.array([1e-6, 1e-5])
ETA = np.array([1, 1.0001, 1.05, 1.33, 1.5, 2.4, 10, 100])
F0 = np.array([0, 1e-4, 0.04, 0.5, 1])


@dataclass(frozen=True)
class Sweep:
    """`function` of the shader `file` over a grid of `axes`; `exact` takes these in the same order.

    `arguments` computes the function's arguments from them; without it they are the axes by name. Values below `floor`
    times the `peak` are left out, and so are those that are no normal float32.
    """

    function: str
    file: str
    case: str
    axes: dict[str, np.ndarray]
    exact: Callable[..., np.ndarray]
    bound: float
    arguments: Callable[..., dict[str, np.ndarray]] | None = None
    peak: Callable[..., np.ndarray] | None = None
    floor: float = 0.0
    defines: dict[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class Errors:
    """Of one sweep: relative error, units in the last place and the limit the rounded arguments set, at each point."""

    relative: np.ndarray
    ulp: np.ndarray
    limit: np.ndarray


def measure(sweep: Sweep) -> Errors:
    """The sweep on the GPU against `exact`, on the full grid of its axes."""
    # The GPU and the reference get the same rounded arguments, so that only the error of the function counts.
    axes = [np.float32(axis).astype(np.float64) for axis in sweep.axes.values()]
    grid = np.meshgrid(*axes, indexing="ij")
    arguments = sweep.arguments(*grid) if sweep.arguments else dict(zip(sweep.axes, grid))
    found = np.asarray(call_glsl(sweep.file, sweep.function, defines=sweep.defines, **arguments), np.float64)
    exact = sweep.exact(*grid)
    if found.ndim > exact.ndim:
        found = found[..., 0]
    smallest = sweep.floor * sweep.peak(*grid) if sweep.peak else TINY
    counted = (exact >= np.maximum(smallest, TINY)) | (exact == 0) & (sweep.peak is None)
    relative = relative_error(found, exact)
    relative[~counted & np.isfinite(found)] = 0.0  # NaN and infinity are wrong everywhere
    spacing = np.spacing(np.maximum(exact, TINY).astype(np.float32)).astype(np.float64)
    ulp = np.where(counted, np.abs(found - exact) / spacing, 0.0)
    limit = np.zeros_like(exact)
    for k in range(len(grid)):
        moved = [a * (1 - HALF_ULP) if j == k else a for j, a in enumerate(grid)]
        limit += np.where(counted & (exact != 0), relative_error(sweep.exact(*moved), exact), 0.0)
    return Errors(relative, ulp, limit)


def relative_error(found: np.ndarray, exact: np.ndarray) -> np.ndarray:
    """|found / exact - 1|. If `exact` is 0, it is 0 or infinity; if `found` is not finite, infinity."""
    with np.errstate(divide="ignore", invalid="ignore"):
        error = np.abs(found - exact) / np.abs(exact)
    error = np.where((exact == 0) & (found == 0), 0.0, error)
    return np.where(np.isfinite(found) & ~np.isnan(error), error, np.inf)


def check_stability() -> Iterator[Check]:
    """A row for every sweep."""
    return map(check_sweep, sweeps())


def check_sweep(sweep: Sweep) -> Check:
    """The largest relative error; the note has units in the last place, the place, and the best that float32 allows."""
    errors = measure(sweep)
    worst = np.unravel_index(np.argmax(errors.relative), errors.relative.shape)
    place = ", ".join(f"{name} {axis[k]:.3g}" for (name, axis), k in zip(sweep.axes.items(), worst))
    note = f"{errors.ulp.max():.0f} ulp; worst at {place}; rounded arguments alone: {errors.limit.max():.1e}"
    return Check("float32", f"{sweep.function}, {sweep.case}", float(errors.relative.max()), sweep.bound, note=note)


def sweeps() -> Iterator[Sweep]:
    """Everything that is measured; the last sweeps of a function are outside the range of its documented bound."""
    yield from _distributions()
    yield from _maskings()
    yield from _fresnels()
    yield from _media()
    display = np.unique(np.concatenate([np.linspace(0, 1, 513), np.geomspace(1e-6, 1, 200)]))
    yield Sweep("srgb_from_linear", "display/srgb.glsl", "0 to 1", {"c": display}, reference.srgb_from_linear, 1e-5,
                lambda c: {"c": np.repeat(c[..., None], 3, axis=-1)})


def _angle_arguments(widths: np.ndarray, alpha: np.ndarray) -> dict[str, np.ndarray]:
    theta = _theta(widths, alpha)
    return {"NoH": np.cos(theta), "s2": np.sin(theta) ** 2, "alpha": alpha}


def _theta(widths: np.ndarray, alpha: np.ndarray) -> np.ndarray:
    """Angles measured in the lobe's own width, up to a cosine of 1e-4."""
    return np.minimum(np.arctan(widths * alpha), np.arccos(1e-4))


def _distributions() -> Iterator[Sweep]:
    # Beckmann and Blinn-Phong are exponentials, which multiply the relative error of an argument of 20 by 20: values
    # below a billionth of the peak are left out. GGX is checked everywhere.
    models = (("ggx", 1e-5, np.geomspace(1e-3, 1e7, 200), 0.0), ("beckmann", 3e-5, np.linspace(0, 4.5, 200), 1e-9),
              ("blinn_phong", 3e-5, np.linspace(0, 4.5, 200), 1e-9))
    for name, bound, widths, floor in models:
        exact = getattr(reference, f"d_{name}")
        for case, alpha in (("alpha >= 1e-3", ALPHA), ("alpha 1e-4", BEYOND_ALPHA)):
            if name == "blinn_phong":
                alpha = alpha[alpha < 1]  # at 1 its exponent is 0, and 0 * log(0) tests nothing
            yield Sweep(f"d_{name}", f"bsdf/{name}.glsl", case, {"angle": np.append(0, widths), "alpha": alpha},
                        lambda widths, alpha, exact=exact: exact(_theta(widths, alpha), alpha), bound,
                        _angle_arguments, lambda widths, alpha, exact=exact: exact(0.0, alpha), floor)


def _maskings() -> Iterator[Sweep]:
    for name, ndf, bound in (("v_smith_ggx", "ggx", 1e-5), ("v_smith_separable_ggx", "ggx", 1e-5),
                             ("v_smith_beckmann", "beckmann", 2e-5), ("v_smith_separable_beckmann", "beckmann", 2e-5)):
        cases = (("cosines >= 1e-4", COSINE, ALPHA), ("cosines 1e-6", BEYOND_COSINE, ALPHA),
                 ("alpha 1e-4", COSINE, BEYOND_ALPHA))
        for case, cosine, alpha in cases:
            yield Sweep(name, f"bsdf/{ndf}.glsl", case, {"NoV": cosine, "NoL": COSINE, "alpha": alpha},
                        getattr(reference, name), bound)
    few = COSINE[::6]
    yield Sweep("v_cavity", "bsdf/v_cavity.glsl", "cosines >= 1e-4",
                {"NoV": few, "NoL": few, "NoH": few, "VoH": few}, reference.v_cavity, 1e-5)


def _fresnels() -> Iterator[Sweep]:
    file = "bsdf/fresnel.glsl"
    for case, cosine in (("cosines >= 1e-4", COSINE), ("cosines 1e-6", BEYOND_COSINE)):
        yield Sweep("f_schlick", file, case, {"f0": F0, "mu": cosine},
                    lambda f0, mu: reference.f_schlick(f0, 1.0, mu), 1e-5,
                    lambda f0, mu: {"f0": np.repeat(f0[..., None], 3, axis=-1), "f90": np.ones(3), "mu": mu})
        yield Sweep("f_dielectric", file, f"eta 1 to 100, {case}", {"mu": cosine, "eta": ETA},
                    reference.f_dielectric, 1e-5)
    # Leaving the denser side, F rises to 1 with a vertical slope at the critical angle: there the rounded arguments
    # decide, and the bound is what they leave.
    critical = np.sqrt(1 - 1 / 1.5**2)
    near = np.concatenate([critical * (1 + np.geomspace(1e-5, 0.3, 100)), critical * np.linspace(0.01, 0.999, 20)])
    yield Sweep("f_dielectric", file, "eta 1 / 1.5, about the critical angle", {"mu": near, "eta": np.array([1 / 1.5])},
                reference.f_dielectric, 1e-3)
    metals = {"mu": COSINE, "eta": np.array([0.05, 0.2, 1, 1.5, 4]), "k": np.array([0, 0.1, 1, 3, 8, 100])}
    yield Sweep("f_conductor(float, float, float)", "bsdf/fresnel_metal.glsl", "metals", metals,
                reference.f_conductor, 1e-5)


def _media() -> Iterator[Sweep]:
    small = "media/one_minus_exp.glsl"
    yield Sweep("one_minus_exp(float)", small, "1e-30 to 1e6", {"x": np.geomspace(1e-30, 1e6, 2000)},
                lambda x: -np.expm1(-x), 1e-6)
    below_1 = np.concatenate([np.geomspace(1e-30, 0.5, 1000), 1 - np.geomspace(0.5, 2.0**-24, 200)])
    yield Sweep("minus_log_one_minus", small, "1e-30 to 1", {"x": below_1}, lambda x: -np.log1p(-x), 1e-6)
    mu = np.unique(np.concatenate([np.linspace(-1, 1, 200), 1 - np.geomspace(1e-7, 1, 60),
                                   np.geomspace(1e-7, 1, 60) - 1]))
    g = np.array([-0.99, -0.9, -0.5, -1e-3, -1e-6, 0, 1e-6, 1e-3, 0.5, 0.9, 0.99])
    yield Sweep("phase_eval", "media/phase.glsl", "g -0.99 to 0.99", {"g": g, "mu": mu},
                media_reference.henyey_greenstein, 1e-5)
    file = "media/distance.glsl"
    for limit in (1e-6, 1.0, 1e6):
        # Beyond u = 0.99 the few digits of 1 - u decide.
        yield Sweep("bounded_distance", file, f"optical depths 1e-6 to 1e4, limit {limit:g}",
                    {"sigma_t": np.geomspace(1e-6, 1e4, 60) / limit, "limit": np.array([limit]),
                     "u": np.concatenate([np.geomspace(1e-7, 0.5, 60), np.linspace(0.5, 0.99, 20)])},
                    media_reference.bounded_distance, 1e-5)
    axes = {"tau": np.append(0, np.geomspace(1e-6, 1e4, 80)), "ratio": np.array([1e-3, 0.1, 0.9, 1, 1.1, 10, 1e3])}
    for name in ("passing_weight", "collision_weight"):
        yield Sweep(name, file, "optical depths 0 to 1e4", axes, getattr(media_reference, name), 1e-5,
                    lambda tau, ratio: {"sigma_t": np.stack([np.ones_like(ratio), ratio, ratio], axis=-1),
                                        "chances": np.full(3, 1 / 3), "distance": tau},
                    lambda tau, ratio: np.ones_like(tau), 1e-30)
