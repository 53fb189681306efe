"""The switches of shaders/bsdf that the settings give, the same for both renderers."""

from __future__ import annotations

from ..settings import MASKINGS, NDFS, Settings


def bsdf_switches(settings: Settings) -> dict[str, int]:
    """The Cook-Torrance factors D, G and F, multiple scattering, and which contributions are shown."""
    return {
        "NDF": NDFS.index(settings.ndf),
        "MASKING": MASKINGS.index(settings.masking),
        "FRESNEL": int(settings.fresnel == "exact"),
        "MULTISCATTER": int(settings.multiscatter == "on"),
        "SHOW_DIFFUSE": int(settings.lobes in ("all", "uniform-diffuse")),
        "SHOW_SPECULAR": int(settings.lobes in ("all", "specular")),
        "SHOW_MULTISCATTER": int(settings.lobes in ("all", "directional-diffuse")),
    }
