"""What a plan leaves out, and why, in words."""

from __future__ import annotations

from collections.abc import Sequence

from ..base.counted import counted
from ..material.fold import without_constant_maps
from ..scene.light import KINDS, Light
from ..scene.material import ANISOTROPY
from ..scene.mesh import Mesh
from ..scene.scene import Scene
from ..scene.schema import MAPS, SWITCHED
from ..settings import Settings
from .deferral import MOST_OBJECTS, MOST_TRIANGLES, is_worth_deferring
from .glass_walls import walls_in_one_layer
from .media import MAX_VOLUMES
from .model import LAYERS_LEFT_OUT, Draw, Plan
from .samplers import MAX_SAMPLERS
from .shadow_layers import MAX_SHADOW_LAYERS

_TILE_MB = 2048 * 2048 * 4 / 1e6
ATTRIBUTE_BYTES = {"a_normal": 12, "a_tangent": 16, "a_color": 16, "a_uv0": 8, "a_uv1": 8}
_GIVEN_UP = {
    "TRACED_REFRACTION": "traced refraction",
    "TRACED_REFLECTION": "traced reflections",
    "VISIBILITY": "visibility of the environment",
    **{f"{name.upper()}_MAP": f"the map {name}" for name in MAPS},
}
_ATTRIBUTES = {
    "a_tangent": "tangents: no surface needs them",
    "a_color": "vertex colours: there are none",
    "a_uv1": "second texture coordinates: no map reads them",
}


def left_out_lines(plan: Plan, scene: Scene, settings: Settings, lights: Sequence[Light]) -> list[str]:
    """One line for each thing that the scene or the settings make unnecessary."""
    lines, draws = [], plan.kinds
    if not scene.instances and not scene.volumes and not scene.curves:
        return ["everything but the background: the scene is empty"]
    any_lit = is_any_lit(draws)
    uses_lights = any_lit or plan.media is not None or plan.curves is not None
    if not draws:
        lines.append("all shading of surfaces: the scene has none")
    elif not any_lit:
        lines.append(f"all lighting{' of surfaces' * uses_lights}: every surface is unlit")
    elif scene.environment is None:
        lines.append("image-based lighting, its bake and textures: there is no environment")
    faint = sum(light.intensity * max(light.color) > 0 for light in lights) - len(plan.lights)
    if uses_lights and not plan.lights:
        lines.append("code for point, spot and directional lights: there are none")
    elif uses_lights and faint > 0:
        lines.append(f"the {faint} faintest of {faint + len(plan.lights)} lights: a program can have no more")
    if plan.lights and not plan.shadow_layer_count:
        reason = "they are switched off" if settings.shadows == "off" else "no light casts shadows"
        lines.append(f"shadow maps: {reason}; saves {_TILE_MB:.0f} MB per tile")
    elif lost := sum(light.casts_shadow and k < 0 for light, k in zip(plan.lights, plan.shadow_layers, strict=True)):
        lines.append(f"shadow maps of {counted(lost, 'light')}: there is room for {MAX_SHADOW_LAYERS} tiles")
    for kind in KINDS:
        if plan.lights and not any(light.kind == kind for light in plan.lights):
            lines.append(f"code for {kind} lights: there are none")
    if draws and plan.environment and scene.environment is not None and not plan.has_visibility:
        reason = "not requested" if settings.environment_shadows == "off" else "all surfaces are transparent"
        lines.append(f"shadows of the environment: {reason}")
    if draws and plan.environment and scene.environment is not None and not plan.has_traced_reflections:
        is_off = settings.reflections == "environment"
        reason = "not requested" if is_off else "no opaque surface is smooth and isotropic"
        lines.append(f"traced reflections: {reason}")
    for switch, what in _GIVEN_UP.items():
        surfaces = sum(plan.count(draw) * (switch in draw.given_up) for draw in draws)
        if surfaces:
            lines.append(f"{what} of {counted(surfaces, 'surface')}: with their maps a program would sample more than "
                         f"{MAX_SAMPLERS} textures")
    lines += omitted_features(scene, settings)
    scattering = sum(material.medium.scatters for material in scene.materials)
    if scattering and not plan.has_subsurface:
        lines.append(f"scattering in the volumes of {counted(scattering, 'material')}: "
                     + (_reason(settings, settings.subsurface != "off") if settings.mode == "pbr" else
                        "modes pbr and path have it"))
    if draws and settings.antialias == "deferred-4" and not is_worth_deferring(scene):
        lines.append(f"shading after all triangles are drawn (deferred-4): there are more than {MOST_OBJECTS} "
                     f"objects or {MOST_TRIANGLES} triangles, so each triangle is shaded, as by msaa-4")
    if any_lit and not plan.has_indirect and settings.mode == "pbr":
        reason = "not requested" if settings.indirect == "off" else (
            "it is estimated instead" if plan.estimates_indirect and plan.has_visibility else
            "the scene is convex: no surface sees another" if settings.indirect == "baked" else
            "it is estimated only together with environment-shadows")
        lines.append(f"baked indirect light: {reason}")
    if settings.background != "env" or scene.environment is None:
        reason = "there is none" if scene.environment is None else "not requested"
        lines.append(f"the environment as background: {reason}")
    if plan.media is None or not plan.media.has_fog:
        lines.append("fog: there is none")
    if not scene.curves:
        lines.append("curves: there are none")
    elif plan.curves is None:
        lines.append(f"curves: {_reason(settings, True)}")
    if not scene.volumes:
        lines.append("volumes: there are none")
    elif len(scene.volumes) > MAX_VOLUMES:
        lines.append(f"the last {len(scene.volumes) - MAX_VOLUMES} of {len(scene.volumes)} volumes: a program can have "
                     "no more")
    lines.append(LAYERS_LEFT_OUT)
    if plan.ground is None:
        reason = "not requested" if settings.ground == "off" else "nothing casts one, or no light falls on it"
        lines.append(f"the shadow on the ground: {reason}")
    if not plan.has_blended:
        lines.append("the sorted pass for blending: no surface blends")
    if not (plan.has_thin_transmission or plan.has_solid_transmission):
        is_glass = settings.mode == "phong" and any(material.transmits for material in scene.materials)
        reason = "in mode phong glass is opaque" if is_glass else "no surface transmits light"
        lines.append(f"the blurred picture behind transmissive surfaces: {reason}")
    lines += walls_in_one_layer(plan, scene)
    for attribute, text in _ATTRIBUTES.items():
        if not any(attribute in draw.attributes for draw in draws):
            saved = ATTRIBUTE_BYTES[attribute] * sum(len(mesh.positions) for mesh in _drawn(plan, scene)) / 1e6
            lines.append(f"{text}; saves {saved:.3g} MB")
    return lines


def _reason(settings: Settings, is_wanted: bool) -> str:
    """Why something is left out that all lobes together would show, if the settings want it."""
    return f"lobes={settings.lobes} is without it" if is_wanted and settings.lobes != "all" else "not requested"


def omitted_features(scene: Scene, settings: Settings) -> list[str]:
    """Lines for the features of materials that no surface has, and for those that cannot be shown."""
    materials = [without_constant_maps(scene.materials[k])
                 for k in {scene.meshes[instance.mesh].material for instance in scene.instances}]
    lines = _omitted_anisotropy(scene, settings)
    for feature in SWITCHED:
        having = [material for material in materials if feature.is_on(material)]
        if not having:
            lines.append(f"{feature.title}: no surface has it")
        elif settings.mode == "phong" and "phong" not in feature.models and not all(m.unlit for m in having):
            lines.append(f"{feature.title}: mode phong does not show it")
    return lines


def _omitted_anisotropy(scene: Scene, settings: Settings) -> list[str]:
    """Lines that say why surfaces with an anisotropic material are shown without anisotropy."""
    if settings.mode == "phong":
        return []
    placed = [scene.meshes[instance.mesh] for instance in scene.instances]
    meshes = [mesh for mesh in placed if mesh.normals is not None
              and ANISOTROPY.is_on(material := scene.materials[mesh.material]) and not material.unlit]
    if meshes and settings.ndf != "ggx":
        return ["anisotropy: only the distribution ggx can be anisotropic"]
    without_tangents = sum(mesh.tangents is None for mesh in meshes)
    reason = "without tangents, and without texture coordinates to compute them"
    return [f"anisotropy of {counted(without_tangents, 'surface')} {reason}"] if without_tangents else []


def _drawn(plan: Plan, scene: Scene) -> list[Mesh]:
    return [scene.meshes[mesh] for mesh in dict.fromkeys(draw.mesh for draw in plan.kinds)]


def is_any_lit(draws: Sequence[Draw]) -> bool:
    return any(draw.program["HAS_NORMAL"] for draw in draws)
