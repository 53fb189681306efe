"""Explains a plan in text: what of the scene is used, what is left out and why, and what that saves."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import TypedDict

from ..material.fold import without_constant_maps
from ..material.use import texture_bytes
from ..scene.light import Light
from ..scene.material import (
    ANISOTROPY,
    CLEARCOAT,
    DIFFUSE_ROUGHNESS,
    DIFFUSE_TRANSMISSION,
    DISPERSION,
    IRIDESCENCE,
    SCATTER,
    SHEEN,
    TRANSMISSION,
    VOLUME,
)
from ..scene.mesh import Mesh
from ..scene.parameter import Feature
from ..scene.scene import Scene
from ..scene.schema import MAPS, SWITCHED
from ..settings import Settings
from .curves import FIBRE_PIXELS, PLY_PIXELS
from .media import MAX_VOLUMES
from .model import LAYERS_LEFT_OUT, Draw, Plan
from .samplers import MAX_SAMPLERS
from .shadow_layers import MAX_SHADOW_LAYERS

_LEVELS_MB = sum((512 >> k) * (1024 >> k) * 6 for k in range(6)) / 1e6  # three half floats per texel
_LEVELS_BAKE_S = 0.11
"""Seconds on one core, with the map in memory. With the cache on disk it is needed only once."""
_DFG_MB = 64 * 128 * 16 / 1e6
_TILE_MB = 2048 * 2048 * 4 / 1e6
_ATTRIBUTE_BYTES = {"a_normal": 12, "a_tangent": 16, "a_color": 16, "a_uv0": 8, "a_uv1": 8}
_KINDS = ("directional", "point", "spot")


class Explanation(TypedDict):
    used: tuple[str, ...]
    left_out: tuple[str, ...]
    saved: dict[str, float]


def explain(plan: Plan, scene: Scene, settings: Settings, lights: Sequence[Light]) -> Explanation:
    """The fields `used`, `left_out` and `saved` of the plan. `lights` are all lights, including those left out."""
    if plan.is_everything:
        return {"used": used_lines(plan), "left_out": ("nothing, as requested",), "saved": {}}
    images, left_out = _unused_images(plan, scene)
    bakes = _skipped_bakes(plan, settings)
    saved = {
        "texture_mb": round(sum(map(texture_bytes, images)) / 1e6 + sum(mb for _, mb, _ in bakes), 3),
        "buffer_mb": round(_unused_attributes(plan, scene) / 1e6, 3),
        "bake_s": round(sum(seconds for _, _, seconds in bakes), 2),
    }
    return {"used": used_lines(plan), "saved": saved,
            "left_out": (*_left_out(plan, scene, settings, lights), *(line for line, _, _ in bakes), *left_out)}


def used_lines(plan: Plan) -> tuple[str, ...]:
    """What the plan draws and looks up, in lines."""
    lines = []
    if plan.draws:
        shared = any(draw.blank_maps for draw in plan.kinds) and not plan.is_everything
        at_once = sum(len(draw.instances) for draw in plan.draws)
        lines.append(f"{_count(len(plan.draws), 'draw')} with {_count(len(plan.programs), 'program')}"
                     + f", of {_count(at_once, 'instance')} at once" * bool(at_once)
                     + ", some shared to compile fewer" * shared)
    if plan.lights:
        kinds = Counter(light.kind for light in plan.lights)
        tiles = f"; {_count(plan.shadow_layer_count, 'shadow map tile')}" * bool(plan.shadow_layer_count)
        lines.append("lights: " + ", ".join(f"{count} {kind}" for kind, count in kinds.items()) + tiles)
    if plan.environment or plan.ambient:
        parts = ["prefiltered levels"] * plan.reflections + ["irradiance map"] * plan.environment
        lines.append("light from the environment: " + ", ".join(parts or ["an ambient colour"]))
    if plan.has_visibility and plan.ambient_occlusion:
        lines.append("ambient occlusion, from the depth buffer")
    elif plan.has_visibility:
        lines.append(f"shadows of the environment, from {_count(plan.environment_shadows, 'light')} sampled from it"
                     + "; what hides one reflects as the mean of all surfaces" * plan.estimates_indirect
                     + "; glass tints them" * plan.tints_sky)
    if plan.has_traced_reflections:
        lines.append("traced reflections of the model: one ray per shaded point, lit by light baked at the vertices")
    if plan.has_traced_refraction:
        lines.append("traced refraction in solid glass: two paths per shaded point")
    if plan.has_indirect:
        lines.append("indirect light, path traced once at the vertices")
    if plan.media is not None:
        media = ["fog"] * plan.media.has_fog + [_count(plan.media.volumes, "volume")] * (plan.media.volumes > 0)
        lines.append(" and ".join(media) + ", marched along rays"
                     + "; light scattered in it many times, by a diffusion equation" * plan.media.scatters_again)
    inside = sum(plan.count(draw) * draw.has_subsurface for draw in plan.kinds)
    if inside:
        lines.append(f"light scattered inside of {_count(inside, 'solid')}, by the thickness behind each point"
                     + ", and spread over the surface in screen space" * plan.spreads_subsurface)
    if plan.curves is not None:
        shown = "strips that face the camera" if not plan.curves.are_yarns else (
            f"yarns, as tubes, from {PLY_PIXELS:g} pixels on as plies and from {FIBRE_PIXELS:g} as fibres")
        lines.append(f"{_count(plan.curves.strands, 'strand')} of curves, as {shown}, with "
                     f"{_count(len(plan.curves.programs), 'program')}; at least {plan.curves.megabytes:.3g} MB"
                     + "; light from fibre to fibre, by a diffusion equation" * plan.curves.scatters_again)
    count = sum(plan.count(draw) * (draw.program.get("WOVEN") == 1) for draw in plan.kinds)
    if count:
        lines.append(f"yarns of {_count(count, 'woven surface')}")
    for layer, what in _LAYERS.items():
        count = sum(plan.count(draw) * _has(draw, layer) for draw in plan.kinds)
        if count:
            lines.append(f"{what} of {_count(count, 'surface')}")
    if plan.grid:
        lines.append("a grid on the ground, and the axes of the world")
    if plan.wireframe:
        lines.append("the edges of all triangles, as lines over the picture")
    textures = {(draw.material, name): texture for draw in plan.kinds for name in draw.maps
                if (texture := MAPS[name].texture(draw.surface))}
    if textures:
        images = {texture.image for texture in textures.values()}
        lines.append(f"{_count(len(textures), 'map')} from {_count(len(images), 'image')}, about "
                     f"{sum(map(texture_bytes, images)) / 1e6:.3g} MB with mipmaps")
    return tuple(lines)


def _reason(settings: Settings, is_wanted: bool) -> str:
    """Why something is left out that all lobes together would show, if the settings want it."""
    return f"lobes={settings.lobes} is without it" if is_wanted and settings.lobes != "all" else "not requested"


def _left_out(plan: Plan, scene: Scene, settings: Settings, lights: Sequence[Light]) -> list[str]:
    """One line for each thing that the scene or the settings make unnecessary."""
    lines, draws = [], plan.kinds
    if not scene.instances and not scene.volumes and not scene.curves:
        return ["everything but the background: the scene is empty"]
    any_lit = _any_lit(draws)
    uses_lights = any_lit or plan.media is not None or plan.curves is not None
    if not draws:
        lines.append("all shading of surfaces: there are none")
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
        lines.append(f"shadow maps of {_count(lost, 'light')}: there is room for {MAX_SHADOW_LAYERS} tiles")
    for kind in _KINDS:
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
            lines.append(f"{what} of {_count(surfaces, 'surface')}: with their maps a program would sample more than "
                         f"{MAX_SAMPLERS} textures")
    lines += omitted_anisotropy(scene, settings) + _ignored_by_phong(scene, settings)
    lines += _omitted_layers(plan, settings)
    scattering = sum(material.medium.scatters for material in scene.materials)
    if scattering and not plan.has_subsurface:
        lines.append(f"scattering in the volumes of {_count(scattering, 'material')}: "
                     + (_reason(settings, settings.subsurface != "off") if settings.mode == "pbr" else
                        "modes pbr and path have it"))
    if any_lit and not plan.has_indirect and settings.mode == "pbr":
        reason = "not requested" if settings.indirect == "off" else (
            "estimated" if plan.estimates_indirect and plan.has_visibility else
            "the scene is convex: no surface sees another" if settings.indirect == "baked" else
            "estimated with shadows of the environment alone")
        lines.append(f"indirect light: {reason}")
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
    for attribute, text in _ATTRIBUTES.items():
        if not any(attribute in draw.attributes for draw in draws):
            saved = _ATTRIBUTE_BYTES[attribute] * sum(len(mesh.positions) for mesh in _drawn(plan, scene)) / 1e6
            lines.append(f"{text}; saves {saved:.3g} MB")
    return lines


def omitted_anisotropy(scene: Scene, settings: Settings) -> list[str]:
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
    return [f"anisotropy of {_count(without_tangents, 'surface')} {reason}"] if without_tangents else []


def _ignored_by_phong(scene: Scene, settings: Settings) -> list[str]:
    """A line for each feature of the materials that mode phong draws without. Of glass another line tells."""
    if settings.mode != "phong":
        return []
    lit = [m for m in (scene.materials[scene.meshes[i.mesh].material] for i in scene.instances) if not m.unlit]
    return [f"{f.title}: mode phong does not show it" for f in SWITCHED
            if "phong" not in f.models and f not in (TRANSMISSION, VOLUME) and any(map(f.is_on, lit))]


def _omitted_layers(plan: Plan, settings: Settings) -> list[str]:
    """Lines for layers that no program has."""
    if settings.mode == "phong":
        return []
    return [f"{what}: no surface has it" for layer, what in _LAYERS.items()
            if not any(_has(draw, layer) for draw in plan.kinds)]


def _has(draw: Draw, layer: Feature) -> bool:
    """Whether its program has the layer for its own material's sake."""
    return bool(draw.program.get(layer.switch)) and layer.is_on(draw.surface)


_LAYERS = {SHEEN: "sheen", CLEARCOAT: "clear coat", IRIDESCENCE: "iridescence",
           DIFFUSE_ROUGHNESS: "rough diffuse reflection", DIFFUSE_TRANSMISSION: "diffuse transmission",
           SCATTER: "scattering in thin walls",
           DISPERSION: "dispersion"}
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


def _skipped_bakes(plan: Plan, settings: Settings) -> list[tuple[str, float, float]]:
    """The tables for image-based lighting that are not baked: a line, MB of texture and seconds of baking for each."""
    if not _any_lit(plan.kinds) or (plan.reflections and plan.dfg):
        return []
    if settings.mode == "phong":
        reason = "mode phong does not use them"
    elif plan.dfg:
        reason = "there is no environment" if not plan.environment else "reflections are not shown"
    else:
        reason = "no surface reflects"
    names = ["prefiltered environment"] * (not plan.reflections) + ["DFG table"] * (not plan.dfg)
    megabytes = _LEVELS_MB * (not plan.reflections) + _DFG_MB * (not plan.dfg)
    seconds = _LEVELS_BAKE_S * (not plan.reflections and (plan.environment or plan.ambient))
    line = f"{' and '.join(names)}: {reason}; saves {megabytes:.3g} MB"
    return [(line + f" and about {seconds:g} s of baking" * bool(seconds), megabytes, seconds)]


def _unused_images(plan: Plan, scene: Scene) -> tuple[set, list[str]]:
    """The images that no program samples, and lines about the maps that are not sampled."""
    sampled = {(draw.material, name) for draw in plan.kinds for name in draw.maps}
    all_maps = {(k, name): texture.image for k, m in enumerate(scene.materials) for name in MAPS
                if (texture := MAPS[name].texture(m))}
    folded = {k: without_constant_maps(scene.materials[k]) for k, _ in all_maps.keys() - sampled}
    constant = {(k, name) for k, name in all_maps.keys() - sampled if MAPS[name].texture(folded[k]) is None}
    given_up = {(draw.material, name) for draw in plan.kinds for name in MAPS
                if f"{name.upper()}_MAP" in draw.given_up}
    unused = all_maps.keys() - sampled - constant - given_up
    images = {all_maps[key] for key in unused | constant} - {all_maps[key] for key in sampled}
    lines = []
    if unused:
        saved = sum(map(texture_bytes, images)) / 1e6
        lines.append(f"{_count(len(unused), 'material map')}, not decoded: no pixel depends on "
                     f"{'them' if len(unused) > 1 else 'it'}; saves {saved:.3g} MB")
    if constant:
        lines.append(f"{_count(len(constant), 'material map')} of one colour: folded into factors")
    return images, lines


def _unused_attributes(plan: Plan, scene: Scene) -> int:
    """The bytes of the vertex attributes that no program reads, of the meshes that are drawn."""
    read: dict[int, set[str]] = {}
    for draw in plan.kinds:
        read.setdefault(draw.mesh, set()).update(draw.attributes)
    return sum(size * len(scene.meshes[mesh].positions) for mesh, names in read.items()
               for name, size in _ATTRIBUTE_BYTES.items() if name not in names)


def _drawn(plan: Plan, scene: Scene) -> list[Mesh]:
    return [scene.meshes[mesh] for mesh in dict.fromkeys(draw.mesh for draw in plan.kinds)]


def _any_lit(draws: Sequence[Draw]) -> bool:
    return any(draw.program["HAS_NORMAL"] for draw in draws)


def _count(count: int, noun: str) -> str:
    return f"{count} {noun}{'s' * (count != 1)}"
