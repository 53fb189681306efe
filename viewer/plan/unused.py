"""Settings for which a scene has nothing: the picture is the same without them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import fields

from ..scene.material import SHEEN
from ..scene.scene import Scene
from ..settings import Settings, ignored
from .media import has_media
from .views import view_settings

_OF_THE_DISPLAY = ("exposure", "tonemap", "ground")
"""What no view of values has, and no plan of one asks for."""


def unused_settings(scene: Scene, settings: Settings) -> list[str]:
    """One line for each thing that `scene` lacks, if settings about it do not have their defaults."""
    default, lines = Settings(), []
    told: set[str] = set()
    for names, is_there, lack in _needs(scene, settings):
        given = [name for name in names if getattr(settings, name) != getattr(default, name) and name not in told]
        if given and not is_there:
            lines.append(f"{' and '.join(given)} {'has' if len(given) == 1 else 'have'} no effect: {lack}")
            told.update(given)
    return lines


def without_effect(scene: Scene, settings: Settings) -> set[str]:
    """The names of all settings that change nothing for what `scene` lacks, whatever their values are."""
    return {name for names, is_there, _ in _needs(scene, settings) if not is_there for name in names}


def _needs(scene: Scene, settings: Settings) -> Iterator[tuple[list[str], bool, str]]:
    """Settings, whether there is what they are about, and what is missing otherwise."""
    kept, elsewhere = view_settings(settings), {"mode", "background", *ignored(settings.mode)}
    lost = [f.name for f in fields(Settings) if f.name not in elsewhere and (
        f.name in _OF_THE_DISPLAY or getattr(kept, f.name) != getattr(settings, f.name))]
    yield lost, not settings.shows_values, f"the setting show is {settings.show}"
    materials = [scene.materials[k] for k in {scene.meshes[instance.mesh].material for instance in scene.instances}]
    is_environment_shown = scene.environment is not None and settings.background == "env"
    has_solid_glass = any(material.transmits and material.thickness > 0 for material in materials)
    yield [*_beginning("hair_"), "curve_radius", "yarn"], bool(scene.curves), "there are no curves"
    yield _beginning("yarn_"), settings.yarn != "off", "the setting yarn is off"
    yield ["weave"], any(mesh.topology == "triangles" for mesh in scene.meshes), "there are no triangles"
    yield _beginning("volume_"), bool(scene.volumes), "there are no volumes"
    yield _beginning("fog_"), settings.fog > 0, "there is no fog"
    yield _beginning("media_"), has_media(scene, settings), "there are no fog and no volumes"
    yield ["sheen"], any(map(SHEEN.is_on, materials)), "no material has a sheen"
    yield ["subsurface"], any(material.medium.scatters for material in materials), "no solid scatters light inside"
    yield ["refraction"], has_solid_glass, "there is no solid glass"
    yield ["photons"], settings.caustics == "photons", "the setting caustics is off"
    yield ["light_radius"], any(light.kind != "directional" for light in scene.lights), (
        "there are no point or spot lights")
    yield ["environment_shadows", "ambient_occlusion", "reflections"], scene.environment is not None, (
        "there is no environment")
    is_estimated = settings.indirect == "estimated"
    yield ["indirect"], not is_estimated or settings.environment_shadows != "off", (
        "it is estimated with environment_shadows only")
    yield ["background_blur"], is_environment_shown, "the background is no environment"


def _beginning(prefix: str) -> list[str]:
    return [f.name for f in fields(Settings) if f.name.startswith(prefix)]
