"""Every lobe of shaders/bsdf: against its float64 twin, and by the laws each owes. Failures that a model is known
for (`Lobe.failures`) must show."""

from __future__ import annotations

import numpy as np
import pytest
import standard_twins
import twins
from contexts import is_software

from viewer.measure.check.chi_squared import critical_value, statistic
from viewer.measure.check.half_vector import Directions, bin_counts, bin_integrals, binned_grid
from viewer.measure.check.lobes import COSINES, DELTA, LOBES, TRANSMISSION, Lobe

COUNT = 20_000
BINS = (16, 10)
NODES = (56, 10)  # 56 * 16 has a cell end at 45 degrees, where what a steep view reflects stops at once
FURNACE_NODES = (28, 6)  # 28 * 16 has one there, too; the integrals differ by less than 5e-5 from those of `NODES`
every_lobe = pytest.mark.parametrize("lobe", LOBES, ids=lambda lobe: lobe.name.replace(" ", "-"))


def upper(rng: np.random.Generator, count: int, lowest: float = 0.0) -> np.ndarray:
    """Directions above the surface, a fifth of them at the sweep's own cosines, as float32 has them."""
    z = rng.uniform(lowest, 1, count)
    z = np.where(rng.random(count) < 0.2, rng.choice([c for c in COSINES if c >= lowest], count), z)
    phi = rng.uniform(0, 2 * np.pi, count)
    s = np.sqrt(1 - z * z)
    return np.stack([s * np.cos(phi), s * np.sin(phi), z], axis=-1).astype(np.float32)


def is_glass(lobe: Lobe) -> bool:
    return bool(lobe.transmits) and "eta" in lobe.parameters


def uniform(rng: np.random.Generator, *shape: int) -> np.ndarray:
    return rng.random((*shape, 3), np.float32)


def sampled(lobe: Lobe, rng: np.random.Generator, m, wo) -> dict[str, np.ndarray]:
    return lobe.sample(m, wo, uniform(rng, *wo.shape[:-1]))


@every_lobe
def test_finite_and_not_negative(lobe):
    """Over random parameters and directions with all the extremes: alpha 0, NoV 1e-6, eta 1 and 100."""
    rng = np.random.default_rng(1)
    m, wo, wi = lobe.draw(rng, COUNT), upper(rng, COUNT), upper(rng, COUNT)
    wi[:, 2] *= np.where(rng.random(COUNT) < 0.5, -1, 1)
    drawn = sampled(lobe, rng, m, wo)
    found = {"f": lobe.eval(m, wo, wi), "pdf": lobe.pdf(m, wo, wi), "albedo": lobe.albedo(m, wo[:, 2]),
             "weight": drawn["weight"], "sample's pdf": drawn["pdf"]}
    for name, values in found.items():
        assert np.isfinite(values).all() and (values >= 0).all(), name
    kept = drawn["flags"] != 0
    assert np.abs(np.linalg.norm(drawn["wi"][kept], axis=-1) - 1).max() < 1e-5
    assert ((drawn["wi"][kept, 2] < 0) == (drawn["flags"][kept] & TRANSMISSION != 0)).all()
    assert (drawn["weight"][~kept] == 0).all()
    if not lobe.transmits:
        assert (found["f"][wi[:, 2] <= 0] == 0).all() and (found["pdf"][wi[:, 2] <= 0] == 0).all()


@every_lobe
def test_weight_is_f_cos_over_pdf(lobe):
    """And the sample's pdf is what pdf says of its direction."""
    rng = np.random.default_rng(2)
    m, wo = lobe.draw(rng, COUNT), upper(rng, COUNT, 0.01)
    for name in m.keys() & {"alpha", "alpha_t", "coat_alpha"}:
        m[name] = np.maximum(m[name], 0.02)  # narrower lobes tell float32 directions apart less well
    drawn = sampled(lobe, rng, m, wo)
    kept = (drawn["flags"] != 0) & (drawn["flags"] & DELTA == 0)
    pdf = lobe.pdf(m, wo, drawn["wi"])
    expected = lobe.eval(m, wo, drawn["wi"]) * np.abs(drawn["wi"][:, 2:]) / np.maximum(pdf, 1e-30)[:, None]
    scale = np.maximum(np.abs(expected).max(axis=-1), 1e-3)
    error = np.abs(drawn["weight"] - expected).max(axis=-1) / scale
    assert kept.mean() > 0.3
    assert np.quantile(error[kept], 0.99) < 3e-3
    assert np.quantile(np.abs(drawn["pdf"] / np.maximum(pdf, 1e-30) - 1)[kept], 0.99) < 3e-3


@every_lobe
def test_reciprocity(lobe):
    """f(wo, wi) = f(wi, wo); through a surface f / eta^2 on either side (Veach 1997, section 5.2)."""
    rng = np.random.default_rng(3)
    m, wo = lobe.draw(rng, COUNT), upper(rng, COUNT, 0.01)
    for name in m.keys() & {"alpha", "alpha_t", "coat_alpha"}:
        m[name] = np.maximum(m[name], 0.02)
    wi = np.where(rng.random((COUNT, 1)) < 0.5, sampled(lobe, rng, m, wo)["wi"], upper(rng, COUNT, 0.01))
    above = wi[:, 2] > 0.01
    forth, back = lobe.eval(m, wo, wi), lobe.eval(m, wi, wo)
    if lobe.transmits:
        below = wi[:, 2] < -0.01
        eta = m["eta"] if lobe.transmits == "refracted" else np.ones(COUNT)
        turned = {**m, "eta": np.where(below, 1 / m["eta"], m["eta"])} if lobe.transmits == "refracted" else m
        flip = np.where(below, -1, 1)[:, None]
        back = lobe.eval(turned, flip * wi, flip * wo) / np.where(below, eta**2, 1)[:, None]
        # The half vector of what is refracted is good to 1e-7 / |eta - 1|, of alpha.
        clear = (np.abs(eta - 1) > 0.04) & (np.abs(1 / eta - 1) > 0.04) & (eta < 10)
        above |= below & (clear | (lobe.transmits == "mirrored"))
    error = (np.abs(forth - back) / np.maximum(np.maximum(forth, back), 1e-3)).max(axis=-1)[above]
    if "reciprocity" in lobe.failures:
        assert np.quantile(error, 0.9) > 0.05
    else:
        assert error.max() < 5e-3 and np.quantile(error, 0.99) < 2e-3


ALPHAS = (0.003, 0.03, 0.2, 1.0)
ALBEDO_COSINES = np.array([1.0, 0.6, 0.25, 0.05])


def seen_at(cosines: np.ndarray) -> np.ndarray:
    """Directions wo (K, 3)."""
    s = np.sqrt(1 - cosines**2)
    return np.stack([s * np.cos(0.7), s * np.sin(0.7), cosines], axis=-1)


FEW_WO = seen_at(np.tile(ALBEDO_COSINES, len(ALPHAS)))


@pytest.fixture(scope="module")
def few_reflected() -> Directions:
    """Where FEW_WO reflect to, for all lobes."""
    return binned_grid(FEW_WO, BINS, NODES)


def few_sets(lobe: Lobe) -> dict[str, np.ndarray]:
    """Parameter sets, one for each of FEW_WO, for what takes a whole hemisphere each."""
    rng = np.random.default_rng(4)
    count = len(ALPHAS) * len(ALBEDO_COSINES)
    m = lobe.draw(rng, count)
    if "alpha" in m:
        m["alpha"] = np.tile(np.repeat(ALPHAS, len(ALBEDO_COSINES))[:, None], 2)[:, : m["alpha"][0].size].squeeze()
        if m["alpha"].ndim == 2:  # and some stretched threefold
            m["alpha"][1::2, 1] = np.minimum(3 * m["alpha"][1::2, 1], 1)
    if "alpha_t" in m:
        m["alpha_t"] = np.minimum(m["alpha"] * np.where(np.arange(count) % 2, 3, 1), 1)
    if is_glass(lobe):
        m["eta"] = rng.choice([1.2, 1.5, 2.4, 1 / 1.5 if lobe.transmits == "refracted" else 1.0], count)
    return m


def columns(m: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    return {name: value[:, None] if np.ndim(value) else value for name, value in m.items()}


@every_lobe
def test_samples_follow_pdf(lobe, few_reflected):
    """The pdf integrates to the share of samples that are no mirror's and stay above the surface; and their histogram
    is its integral over each bin, by chi-squared at 1 % for all the sets together (Sidak 1967)."""
    m, wo = few_sets(lobe), FEW_WO
    draws = 1 << 14
    drawn = lobe.sample(columns(m), wo[:, None], uniform(np.random.default_rng(5), len(wo), draws))
    kept = (drawn["flags"] != 0) & (drawn["flags"] & DELTA == 0)
    through = drawn["flags"] & TRANSMISSION != 0
    integral, tests = np.zeros(len(wo)), []
    for beyond in [False, True] if lobe.transmits else [False]:
        eta = m["eta"] if beyond and lobe.transmits == "refracted" else None
        side = np.array([1, 1, -1 if beyond and lobe.transmits == "mirrored" else 1])
        grid = few_reflected if eta is None else binned_grid(wo, BINS, NODES, eta)
        shares = bin_integrals(lambda wi, side=side: lobe.pdf(columns(m), wo[:, None], wi * side), grid, BINS)
        integral += shares.sum(axis=1)
        for counts, share in zip(bin_counts(wo, drawn["wi"] * side, kept & (through == beyond), BINS, eta), shares):
            if counts.any() or share.sum() > 1e-4:
                tests.append(statistic(counts, draws * share))
    share = kept.mean(axis=1)
    assert (np.abs(integral - share) < 3e-3 + 4.5 * np.sqrt(np.maximum(share * (1 - share), 1e-5) / draws)).all()
    assert len(tests) >= len(wo)
    assert max(chi2 / critical_value(degrees, len(tests)) for chi2, degrees in tests) < 1


@every_lobe
def test_albedo(lobe):
    """What the lobe says of its albedo is the mean weight of its samples, and never above 1."""
    m, wo = few_sets(lobe), FEW_WO
    draws = 1 << 15
    drawn = lobe.sample(columns(m), wo[:, None], uniform(np.random.default_rng(6), len(wo), draws))
    power = drawn["weight"] * (drawn["eta"] ** 2)[..., None]  # of radiance, denser beyond by eta^2
    mean, spread = power.mean(axis=1), power.std(axis=1) / np.sqrt(draws)
    found = lobe.albedo(m, wo[:, 2])
    is_isotropic = np.ptp(m["alpha"], axis=-1) == 0 if np.ndim(m.get("alpha")) == 2 else np.ones(len(wo), bool)
    if "alpha_t" in m and lobe.defines["ANISOTROPIC"]:
        is_isotropic = m["alpha_t"] == m["alpha"]
    sampled_64 = not lobe.table or lobe.transmits == "refracted"
    tolerance = 0.025 if sampled_64 else 0.012 if "sheen_roughness" in m else 0.004
    gap = np.abs(found - mean) - 5 * spread - tolerance * np.maximum(mean, 1)
    assert gap[is_isotropic].max() < 0
    excess = (mean - 5 * spread).max() - 1
    white = lobe.struct(metallic=0.0) if lobe.file == "surface" else lobe.white
    NoV = np.linspace(0.01, 1, 50)
    brightest = max(float(lobe.albedo({**white, **extreme}, NoV).max()) for extreme in extremes(lobe))
    if "energy" in lobe.failures:
        assert brightest > 1.005
    else:
        assert excess < 2e-3 and brightest < 1.005


def extremes(lobe: Lobe) -> list[dict[str, float]]:
    """The lobe's roughness, or what takes its place, over its range."""
    for name, values in {"alpha": ALPHAS, "sigma": (0, 0.5, 1), "perceptual_roughness": (0, 0.5, 1),
                         "shininess": (1, 10, 100)}.items():
        if name in lobe.parameters:
            return [{name: value} for value in values]
    return [{}]


COMPENSATED = {"turquin": 5e-3, "fdez_aguera": 5e-3, "metal": 2e-3, "conductor": 2e-3, "standard": 5e-3,
               "standard anisotropic": 5e-3, "standard rough": 5e-3, "standard coated": 5e-3,
               "standard iridescent": 5e-3,
               "standard translucent": 5e-3, "standard scattering": 5e-3, "standard sheen": 1e-2,
               "standard zeltner sheen": 5e-3}


FURNACE = np.array([(rough, NoV) for rough in np.linspace(0.05, 1, 12) for NoV in (1.0, 0.6, 0.25, 0.1, 0.05)])
FURNACE_WO = seen_at(FURNACE[:, 1])


@pytest.fixture(scope="module")
def furnace_reflected() -> Directions:
    return binned_grid(FURNACE_WO, BINS, FURNACE_NODES)


@pytest.mark.parametrize("name", ["lambert", "eon", *COMPENSATED])
def test_white_furnace(name, furnace_reflected):
    """What absorbs nothing returns all, at every roughness and for NoV down to 0.05."""
    (lobe,) = (lobe for lobe in LOBES if lobe.name == name)
    rough, wo = FURNACE[:, 0], FURNACE_WO
    white = dict(lobe.white)
    if "alpha" in white:
        white["alpha"] = (rough**2)[:, None].repeat(lobe.parameters["alpha"].size, axis=1).squeeze()
    if "alpha_t" in white:
        white["alpha_t"] = white["alpha"]
    if "sigma" in white:
        white["sigma"] = rough

    def light(wi):
        sides = [1, -1] if lobe.transmits else [1]
        f = sum(lobe.eval(columns(white), wo[:, None], wi * np.float32([1, 1, side]))[..., 0] for side in sides)
        return f * wi[..., 2]

    total = bin_integrals(light, furnace_reflected, BINS).sum(axis=1)
    assert np.abs(total - 1).max() < COMPENSATED.get(name, 1e-3)


TWINS = [(lobe, alpha) for lobe in LOBES if lobe.prefix != "microfacet"
         for alpha in ((0.01, 0.1, 0.5, 1.0) if "alpha" in lobe.parameters else (0.0,))]


@pytest.mark.parametrize(("lobe", "alpha"), TWINS, ids=lambda value: getattr(value, "name", value))
def test_against_float64(lobe, alpha):
    """f at directions the lobe samples and at others."""
    is_compensated = lobe.name in COMPENSATED
    rng = np.random.default_rng(8)
    count = 4000
    if is_compensated:
        count = 100  # the twin takes two integrals for each direction
    elif lobe.name == "thin_dielectric with a film":
        count = 1000  # the twin takes a spectrum for each order between the faces
    m = {name: np.asarray(value, np.float32).astype(float) for name, value in lobe.draw(rng, count).items()}
    if "alpha" in m:
        m["alpha"] = np.full_like(m["alpha"], np.float32(alpha))
        if m["alpha"].ndim == 2 and not is_compensated:
            m["alpha"][:, 1] = np.float32(0.3)
    if "alpha_t" in m:
        m["alpha_t"] = np.minimum(3 * m["alpha"], 1)
    if "coat_alpha" in m:
        m["coat_alpha"] = np.full_like(m["coat_alpha"], np.float32(0.2))
    if "sheen_roughness" in m:
        m["sheen_roughness"] = np.full_like(m["sheen_roughness"], np.float32(0.5))
    if "film" in m:  # where the fits of its spectrum and of its albedo are meant to be good
        m["film_ior"], m["film_thickness"] = (rng.uniform(*ends, count).astype(np.float32).astype(float)
                                              for ends in ((1.2, 1.8), (50, 700)))
        m |= {"ior": np.maximum(m["ior"], 1)} if "ior" in m else {}
    if lobe.name == "conductor":
        m["eta"], m["k"] = (rng.uniform(0.1, 5, (count, 3)).astype(np.float32).astype(float) for _ in range(2))
    if is_glass(lobe):
        m["eta"] = rng.choice(np.float32([1.2, 1.5, 2.4, 1 / 1.5 if lobe.transmits == "refracted" else 1]), count)
        m["eta"] = m["eta"].astype(float)
    wo = upper(rng, count, 0.02)
    drawn = lobe.sample(m, wo, uniform(rng, count))
    wi = np.where(((drawn["flags"] != 0) & (rng.random(count) < 0.8))[:, None], drawn["wi"], upper(rng, count, 0.02))
    usable = np.abs(wi[:, 2]) > 0.01
    m, wo, wi = {name: value[usable] for name, value in m.items()}, wo[usable], wi[usable]
    found = lobe.eval(m, wo, wi)
    name = lobe.prefix if is_glass(lobe) else lobe.name.replace(" ", "_")
    twin = getattr(standard_twins if name.startswith("standard") else twins, name)
    masking = {"is_separable": lobe.defines["MASKING"] == 1} if is_glass(lobe) else {}
    expected = twin(m, wo.astype(float), wi.astype(float), **masking) + 0 * found
    assert np.isfinite(expected).all()
    error = np.abs(found - expected)
    if lobe.name in ("metal", "conductor"):  # 1 - E, which the table has to 7e-4, over its mean
        assert (error / np.maximum(expected, 0.1)).max() < (1.5e-2 if alpha == 0.01 else 4e-3)
    elif is_compensated:  # 1 - E of a smooth interface towards grazing is where the table is least exact
        near_mirror = lobe.file == "surface" and alpha == 0.01
        limit = (1.5e-2 if "coat_alpha" in m else 8e-3) if near_mirror else 1.5e-3
        if lobe.defines.get("ANISOTROPIC"):  # the twin has the albedo of both alphas, of which the table has E to 3e-3
            limit = max(limit, 6e-3)
        limit = 2e-2 if "sheen_roughness" in m else limit  # the albedo of fibres is a fit
        limit = 4e-2 if "film_walls" in m else limit  # the albedo below a film is a mean over six normals
        assert (error / np.maximum(expected, 0.1)).max() < limit
    elif "shininess" in m:  # of up to 1e4, times the rounding of a cosine
        assert (error / np.maximum(expected, 1e-3)).max() < 3e-3
    elif "film" in m:  # the spectrum is a fit, and its orders are cut off
        bare = m | {"film": np.zeros(len(wo))}
        all_light = sum(twin(bare | dict.fromkeys(("f0", "f90"), np.full((len(wo), 3), share)), wo.astype(float),
                             wi.astype(float)) for share in (0.0, 1.0))
        assert (error / np.maximum(all_light, 1e-3)).max() < 4e-2 + 3e-7 / alpha  # most over what reflects as a metal
    else:  # float32 directions tilt h by 1e-7, of alpha
        bound = 1e-5 if is_software() else 2e-5
        assert (error / np.maximum(expected, 1e-3)).max() < bound + (3e-7 / alpha if alpha else 0)
