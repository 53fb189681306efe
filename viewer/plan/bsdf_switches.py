"""The switches of shaders/bsdf that follow from the settings, the same for both renderers."""

from __future__ import annotations

from collections.abc import Mapping

from ..scene.material import ANISOTROPY
from ..settings import MASKINGS, NDFS, Settings


def feature_switches_shown(switches: Mapping[str, int], settings: Settings) -> dict[str, int]:
    """The switches of a material's features, without those that the settings exclude: only GGX can be anisotropic."""
    off = [] if settings.ndf == "ggx" else [ANISOTROPY.switch]
    return {**switches, **dict.fromkeys(off, 0)}


def bsdf_switches(settings: Settings) -> dict[str, int]:
    """The switches for the Cook-Torrance factors D, G and F, multiple scattering, the lobe of a sheen, and
    the contributions to show."""
    return {
        "NDF": NDFS.index(settings.ndf),
        "MASKING": MASKINGS.index(settings.masking),
        "FRESNEL": int(settings.fresnel == "exact"),
        "MULTISCATTER": int(settings.multiscatter == "on"),
        "ZELTNER": int(settings.sheen == "zeltner"),
        "SHOW_DIFFUSE": int(settings.lobes in ("all", "uniform-diffuse")),
        "SHOW_SPECULAR": int(settings.lobes in ("all", "specular")),
        "SHOW_MULTISCATTER": int(settings.lobes in ("all", "directional-diffuse")),
    }
