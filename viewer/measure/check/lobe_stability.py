"""Lobes' values in float32 against float64, over directions of wo and half vectors.

Both get the same float32 directions. No formula can undo their rounding: a half vector, their sum, is exact to 6e-8,
and so a lobe of width alpha to about 4 times 6e-8 / alpha; and of wo + eta wi only a share |eta - 1| of the digits is
left.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from . import reference
from .checks import Check
from .energy import directions
from .half_vector import reflect, refract
from .lobes import LOBES
from .stability import relative_error

NOV = (1.0, 0.9, 0.5, 0.1, 0.01, 1e-3)
ALPHA = np.array([[a, a] for a in (0.01, 0.03, 0.1, 0.3, 1.0)] + [[0.05, 0.4], [1.0, 0.1]])
ETA = (1.05, 1.5, 2.4, 1 / 1.5)


@dataclass(frozen=True)
class LobeSweep:
    """A lobe of `LOBES` by its name, sets of its parameters, and `exact`, its value in float64."""

    name: str
    parameters: dict[str, np.ndarray]
    exact: Callable[..., np.ndarray]
    bound: float
    eta: np.ndarray | None = None
    mirrors: bool = False
    floor: float = 0.0
    """Smaller values count as this one: towards the light, EON is a difference 1 - 1, whose relative error is large."""


def check_lobe_stability() -> Iterator[Check]:
    """A row for each lobe that has a reference."""
    return map(check_lobe_sweep, lobe_sweeps())


def check_lobe_sweep(sweep: LobeSweep) -> Check:
    """The lobe's largest relative error where its value is not negligible."""
    lobe = next(lobe for lobe in LOBES if lobe.name == sweep.name)
    sets = len(next(iter(sweep.parameters.values())))
    wo = np.repeat(directions(NOV), sets, axis=0).astype(np.float32).astype(np.float64)
    m = {name: np.tile(value, (len(NOV), *[1] * (value.ndim - 1)))[:, None]
         for name, value in sweep.parameters.items()}
    wi, valid = _half_vector_grid(wo, None if sweep.eta is None else np.tile(sweep.eta, len(NOV)))
    wi = wi * [1, 1, -1] if sweep.mirrors else wi
    found = lobe.eval(lobe.struct(**m), wo[:, None], wi)[..., 0].astype(np.float64)
    with np.errstate(all="ignore"):
        exact = sweep.exact(np.broadcast_to(wo[:, None], wi.shape), wi, **m)
    counted = valid & (exact > 1e-6 * np.where(valid, exact, 0).max(axis=1, keepdims=True))
    share = np.minimum(np.where(counted, exact, 0) / max(sweep.floor, 1e-300), 1)
    relative = np.where(counted, relative_error(found, exact), 0.0) * share
    error = np.where(np.isfinite(found), relative, np.inf)
    worst = np.unravel_index(np.argmax(error), error.shape)
    ulp = np.abs(found[worst] - exact[worst]) / np.spacing(np.float32(max(exact[worst], 1e-30)))
    place = ", ".join(f"{name} {np.array2string(value[worst[0], 0], precision=3)}" for name, value in m.items())
    what = f"{sweep.name}, transmitted" if sweep.mirrors or sweep.eta is not None else sweep.name
    return Check("float32", f"{what}, all directions", float(error[worst]), sweep.bound,
                 note=f"{ulp:.0f} ulp; worst at NoV {wo[worst[0], 2]:.2g}, {place}")


def lobe_sweeps() -> Iterator[LobeSweep]:
    """Everything that is measured."""
    sigma = np.linspace(0.01, 1, 7)
    yield LobeSweep("eon", {"sigma": sigma}, lambda wo, wi, sigma: reference.eon(wo, wi, sigma), 1e-5, floor=0.01)
    yield LobeSweep("burley", {"perceptual_roughness": sigma},
                    lambda wo, wi, perceptual_roughness: reference.burley(wo, wi, perceptual_roughness), 1e-5)
    yield LobeSweep("ggx", {"alpha": ALPHA}, lambda wo, wi, alpha: reference.ggx_reflection(wo, wi, alpha)[0], 1e-5)
    # Narrower ones count as mirrors: bsdf.glsl's DELTA_ALPHA.
    # The transmittance of the interface comes from the table of albedos, least exact for smooth ones at grazing.
    yield LobeSweep("standard", {"alpha": ALPHA[:5, 0], "metallic": np.zeros(5)},
                    lambda wo, wi, alpha, metallic: reference.standard_dielectric(wo, wi, alpha), 1e-2)
    pairs = [(eta, alpha) for eta in ETA for alpha in ALPHA if alpha.max() * abs(eta - 1) > 1e-3]
    eta, alpha = np.array([p[0] for p in pairs]), np.array([p[1] for p in pairs])
    # At eta 1.05 the half vector has lost a digit and a half, and alpha takes as many again.
    yield LobeSweep("dielectric", {"eta": eta, "alpha": alpha},
                    lambda wo, wi, eta, alpha: reference.ggx_transmission(wo, wi, alpha, eta), 1e-2, eta)
    yield LobeSweep("thin_dielectric", {"eta": eta, "alpha": alpha},
                    lambda wo, wi, eta, alpha: reference.thin_walled_transmission(wo, wi, alpha, eta), 1e-4,
                    mirrors=True)


def _half_vector_grid(wo: np.ndarray, eta: np.ndarray | None) -> tuple[np.ndarray, np.ndarray]:
    """Float32 directions wi (K, Q, 3), as float64, and whether they exist, with half vectors from 1e-4 on."""
    theta, phi = np.meshgrid(np.append(0, np.geomspace(1e-4, 1.5, 24)), np.linspace(-np.pi, np.pi, 13), indexing="ij")
    theta, phi = (np.tile(a.ravel(), (len(wo), 1)) for a in (theta, phi))
    wi, jacobian = reflect(wo, theta, phi) if eta is None else refract(wo, eta, theta, phi)
    # A grazing direction's cosine has no digits of its own after rounding; 1e-3 keeps three of them.
    return wi.astype(np.float32).astype(np.float64), (jacobian > 0) & (np.abs(wi[..., 2]) > 1e-3)


def check_lobe_extremes() -> Iterator[Check]:
    """Every function of every lobe at extreme arguments: how many numbers are NaN or infinite. None may be."""
    rng = np.random.default_rng(11)
    count, cosines = 400, directions((1.0, 1 - 1e-7, 0.5, 0.1, 1e-3, 1e-6))
    for lobe in LOBES:
        m = {name: value[:, None] for name, value in lobe.draw(rng, count).items()}
        wo = cosines[rng.integers(len(cosines), size=count)][:, None]
        mirror, back = wo * [-1, -1, 1], wo
        scattered = rng.normal(size=(count, 24, 3))
        scattered /= np.linalg.norm(scattered, axis=-1, keepdims=True)
        grazing = scattered * [1, 1, 1e-6]
        wi = np.concatenate([mirror, back, -wo, scattered, grazing], axis=1)
        u = np.concatenate([rng.random((count, 24, 3)), rng.choice([0.0, 1 - 2.0**-24], (count, 8, 3))], axis=1)
        drawn = lobe.sample(m, wo, u)
        results = {"eval": lobe.eval(m, wo, wi), "pdf": lobe.pdf(m, wo, wi), "albedo": lobe.albedo(m, wo[..., 2]),
                   **{f"sample's {name}": drawn[name] for name in ("wi", "weight", "pdf")}}
        broken = {name: int((~np.isfinite(found)).sum()) for name, found in results.items()}
        note = ", ".join(f"{name} {number}" for name, number in broken.items() if number)
        yield Check("no NaN, no Inf", f"{lobe.name}, all functions at extremes", sum(broken.values()), 0, note=note)
