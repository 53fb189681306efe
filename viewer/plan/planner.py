"""Plans what is needed to show a scene: the programs, textures and passes, and what is left out and why.

The plan follows from the scene and the settings, before anything is compiled or uploaded. A shader program is a
fragment file with switches. It contains only what the mesh, its material, the lights and the settings need.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import replace

from ..errors import UsageError
from ..material.fold import without_constant_maps
from ..material.use import DELTA_ALPHA, feature_switches, may_be_pane, metalness, supported, used_maps
from ..scene.convex import is_convex
from ..scene.light import KINDS, Light
from ..scene.material import ANISOTROPY, DIFFUSE_TRANSMISSION, Material
from ..scene.mesh import Mesh
from ..scene.scene import Scene
from ..scene.schema import MAPS, SWITCHED
from ..scene.texture_image import TextureImage
from ..scene.woven import woven
from ..settings import Settings
from .bsdf_switches import bsdf_switches
from .curves import draws_curves, plan_curves
from .deferral import can_defer, is_worth_deferring
from .explain import explain
from .grooves import with_grooves
from .ground import plan_ground
from .instances import instances_of, is_instanced, placed
from .lookups import coat_lookups, lookups
from .map_switches import ALPHA_MODES, map_switches
from .media import has_media, hides_light, media_switches, plan_media
from .model import ALONE, NO_SUBSURFACE, SPREAD, THIN_WALLED, Draw, Plan, Program
from .samplers import within_limit
from .shadow_layers import shadow_layers
from .sharing import attributes_of, include_everything, share_programs
from .views import plan_view

MAX_LIGHTS = 128
"""The most lights in one program. They fit in a uniform block of 16 KiB, the least that OpenGL 3.3 guarantees."""
TRACED_ROUGHNESS = 1.0
"""Surfaces of this perceptual roughness or more trace no reflections: traced_share() in
shaders/raster/traced_reflection.glsl is 0 there."""


def is_lit(mesh: Mesh, material: Material) -> bool:
    """Whether the mesh is shaded. Lines and points without normals are not (glTF 2.0, section 3.7.2.1), and neither are
    unlit materials."""
    return mesh.normals is not None and not material.unlit


def environment_use(scene: Scene, settings: Settings) -> tuple[bool, bool]:
    """Whether the environment lights any surface or medium, and whether any surface reflects it and needs its
    prefiltered levels."""
    if settings.shows_values:
        return False, False
    if settings.plan == "everything":
        return True, True
    if scene.environment is None:
        return False, False
    meshes = (scene.meshes[mesh] for mesh in instances_of(scene))
    lit = [material for mesh in meshes if is_lit(mesh, material := scene.materials[mesh.material])]
    shows = settings.mode == "pbr" and settings.lobes in ("all", "specular")
    curves = draws_curves(scene, settings)
    is_reflected = (curves and settings.mode == "pbr") or (shows and any(material.reflects for material in lit))
    return curves or bool(lit) or has_media(scene, settings), is_reflected


def plan_scene(
    scene: Scene, settings: Settings, lights: Sequence[Light], *, samples: int, half_target: bool, orthographic: bool,
    deferred: bool = False, grooved: Collection[TextureImage] = (),
) -> Plan:
    """The plan for rasterising `scene` with `settings`.

    `lights` are all lights, including the suns extracted from the environment. `samples` is the number of samples per
    pixel of the render target (MSAA), and `half_target` tells whether it stores half floats. `orthographic` tells
    whether the camera is orthographic, and `deferred` whether a multisampled picture may shade surfaces after all
    triangles are drawn (viewer/raster/deferred.py). `grooved` are the normal maps that are known to have grooves, which
    stretch lobes (viewer/scene/normal_spread.py). Raises UsageError for mode path, which the raster cannot draw.
    """
    if settings.mode == "path":
        raise UsageError("the raster cannot draw mode path")
    if settings.shows_values:
        shaded = plan_scene(scene, replace(settings, show="shaded", plan="needed"), lights, samples=samples,
                            half_target=half_target, orthographic=orthographic) if settings.show == "overdraw" else None
        return plan_view(scene, settings, shaded, samples=samples, half_target=half_target, orthographic=orthographic)
    scene = woven(scene, settings)
    instances = instances_of(scene)
    lit = [is_lit(scene.meshes[mesh], scene.materials[scene.meshes[mesh].material]) for mesh in instances]
    curves = draws_curves(scene, settings)
    shown_lights = ordered_lights(lights) if any(lit) or curves or has_media(scene, settings) else ()
    has_shadows = settings.shadows == "on" and (bool(scene.instances) or curves)
    layers, layer_count = shadow_layers(shown_lights, scene) if has_shadows else ((-1,) * len(shown_lights), 0)
    environment, reflections = environment_use(scene, settings)
    photons = settings.caustics == "photons" and settings.mode == "pbr"
    has_open_panes = any(is_clear(material, settings) for material in scene.materials) and not (
        photons and all(light in scene.lights for light in shown_lights))
    environment_shadows = _environment_shadows(settings) if environment and scene.environment is not None else 0
    ambient_occlusion = (settings.ambient_occlusion != "off" and settings.mode == "pbr" and environment
                         and scene.environment is not None and not environment_shadows)
    common = {
        "VISIBILITY": int(environment_shadows > 0 or ambient_occlusion),
        "TRACED_REFLECTION": int(settings.reflections == "traced" and reflections and scene.environment is not None),
        "INDIRECT": int(_has_indirect(scene, settings)),
        "HALF_TARGET": int(half_target),
        "SAMPLES": samples,
        "DEFERRED": int(deferred and samples > 1 and settings.plan == "needed" and is_worth_deferring(scene)),
        "IS_ORTHOGRAPHIC": int(orthographic),
        "LIGHT_COUNT": len(shown_lights),
        "DIRECTIONAL_COUNT": sum(light.kind == "directional" for light in shown_lights),
        "POINT_COUNT": sum(light.kind == "point" for light in shown_lights),
        "SUNS": int(any(light.angular_radius > 0 for light in shown_lights)),
        "SHADOW_LAYERS": layer_count,
        "SHADOW_PATTERN": int(layer_count > 0 and (has_open_panes or any(material.alpha_mode == "blend"
                                                                         for material in scene.materials))),
        "HAS_ENVIRONMENT": int(environment),
        "ENVIRONMENT_ROTATED": int(scene.environment is not None and scene.environment.rotation != 0),
        "SHOW_EMISSION": int(settings.lobes == "all"),
        **media_switches(scene, settings),
        "SKY_SHADOWS": int(environment and settings.fog > 0 and hides_light(scene, settings)),
    }
    # Instances of a mesh are drawn alike, and there may be a hundred thousand of them.
    kinds = [_draw(k, scene.meshes[k], scene.materials, settings, common, len(numbers), grooved)
             for k, numbers in instances.items()]
    if settings.plan == "needed":
        kinds = list(share_programs(kinds))
    draws = placed(dict(zip(instances, kinds, strict=True)), instances)
    background = settings.background == "env" and scene.environment is not None
    plan = Plan(
        draws=draws,
        lights=shown_lights,
        shadow_layers=layers,
        shadow_layer_count=layer_count,
        environment=environment and settings.mode == "pbr",
        reflections=reflections,
        ambient=environment and settings.mode == "phong",
        dfg=any(draw.program.fragment == "raster/pbr.frag" and draw.program["REFLECTS"] for draw in kinds),
        environment_shadows=environment_shadows,
        ambient_occlusion=ambient_occlusion,
        estimates_indirect=environment_shadows > 0 and settings.indirect == "estimated",
        background=background,
        ground=plan_ground(settings, common, any(draw.hides_sky for draw in kinds) or curves),
        background_blur=settings.background_blur if background else 0.0,
        media=plan_media(scene, settings, common, sum(light.radius > 0 for light in shown_lights)),
        curves=plan_curves(scene, settings, common),
        wireframe=settings.show == "wireframe",
        grid=settings.grid == "on",
        photons=photons,
    )
    if settings.plan == "everything":
        plan = include_everything(plan, scene)
    return replace(plan, **explain(plan, scene, settings, lights))


def ordered_lights(lights: Sequence[Light]) -> tuple[Light, ...]:
    """The lights that shaders get: directional, point, then spot lights. Of the point lights, those that stand for what
    volumes emit are the last. Lights without intensity are dropped, and so are all but the MAX_LIGHTS brightest."""
    bright = [light for light in lights if light.intensity * max(light.color) > 0]
    if len(bright) > MAX_LIGHTS:
        bright = sorted(bright, key=lambda light: -light.intensity * max(light.color))[:MAX_LIGHTS]
    return tuple(sorted(bright, key=lambda light: (KINDS.index(light.kind), light.radius > 0)))


def _has_indirect(scene: Scene, settings: Settings) -> bool:
    """Whether indirect light is requested, and some surface may receive light from another."""
    is_requested = settings.indirect == "baked" and settings.mode == "pbr"
    return is_requested and (settings.plan == "everything" or not is_convex(scene))


def _environment_shadows(settings: Settings) -> int:
    off = settings.environment_shadows == "off" or settings.mode != "pbr"
    return 0 if off else int(settings.environment_shadows)


def _draw(
    mesh_index: int, mesh: Mesh, materials: Sequence[Material], settings: Settings, common: dict[str, int], count: int,
    grooved: Collection[TextureImage],
) -> Draw:
    """How a mesh of `count` instances is drawn, as instance 0."""
    material = materials[mesh.material]
    if settings.plan == "needed":
        material = without_constant_maps(material)
    material = supported(material, mesh, settings.ndf)
    lit = is_lit(mesh, material)
    if material.transmits or (material.alpha_mode == "blend" and material.weave is None):
        common = common | {"VISIBILITY": 0, "TRACED_REFLECTION": 0}  # the G-buffer holds the opaque surface behind
    if common["VISIBILITY"]:
        common = common | {"SKY_SHADOWS": 0}
    if not _can_trace_reflections(material):
        common = common | {"TRACED_REFLECTION": 0}
    model = settings.mode if lit else "unlit"
    maps = tuple(name for name in used_maps(material, mesh, model, settings.plan == "everything")
                 if _is_shown(name, lit, common))
    textures = {name: texture for name in maps if (texture := MAPS[name].texture(material))}
    features = feature_switches(material, model)
    switches = {
        "ALPHA_MODE": ALPHA_MODES.index(material.alpha_mode),
        "HAS_COLOR": int(mesh.colors is not None),
        "IS_POINTS": int(mesh.topology == "points"),
        "UV_SETS": sum(1 << uv_set for uv_set in {texture.uv_set for texture in textures.values()} | (
            {0} if material.weave is not None else set())),
        "HAS_NORMAL": int(lit),
        "HAS_TANGENT": int(any(features[f.switch] for f in SWITCHED if f.needs_tangents)
                           or any(MAPS[name].info.needs_tangents for name in maps)),
        "INDIRECT": common["INDIRECT"] * lit,
        **features,
        **{name: common[name] for name in ("HALF_TARGET", "SAMPLES", "MEDIA", "DEFERRED", "IS_ORTHOGRAPHIC")},
        "SUBSURFACE": subsurface(material, model, settings),
    }
    switches["INSTANCED"] = int(is_instanced(count, material, switches))
    if switches["SUBSURFACE"]:  # what comes through a solid is a cosine lobe, as that of diffuse transmission is
        switches[DIFFUSE_TRANSMISSION.switch] = 1
    for name in MAPS:
        switches |= map_switches(name.upper(), textures.get(name))
    if lit:
        switches |= common | {"DOUBLE_SIDED": int(material.double_sided)}
        if settings.mode == "pbr":
            switches |= _pbr_switches(material, settings, bool(common["HAS_ENVIRONMENT"]))
        else:
            switches |= _phong_switches(material, settings)
    wanted, switches = switches, within_limit(switches)
    wanted["DEFERRED"] = switches["DEFERRED"] = int(common["DEFERRED"] and can_defer(mesh, material, switches))
    maps = tuple(name for name in maps if switches[f"{name.upper()}_MAP"])
    if model == "pbr" and "normal" in maps and textures["normal"].image in grooved \
            and material.reflects and settings.ndf == "ggx":
        switches = with_grooves(switches)
    program = Program.of(f"raster/{model}.frag", switches)
    transmits = features["HAS_TRANSMISSION"] * (1 + features["IS_SOLID"])
    return Draw(0, mesh_index, mesh.material, material, program, maps, attributes_of(switches), material.alpha_mode,
                transmits, is_pane=transmits == THIN_WALLED and is_clear(material, settings),
                given_up=tuple(name for name in switches if switches[name] != wanted[name]))


def is_clear(material: Material, settings: Settings) -> bool:
    """Whether shadow maps let lights shine through it, but lamps whose light photons bring (`Plan.photons`)."""
    maps = () if material.metallic_roughness_texture is None else ("metallic_roughness",)
    is_glass = settings.mode == "pbr" and settings.lobes in ("all", "specular")
    return is_glass and may_be_pane(material, maps)


def subsurface(material: Material, model: str, settings: Settings) -> int:
    """The switch SUBSURFACE of a lit surface: how light that the volume behind it scatters is drawn."""
    is_shown = model == "pbr" and settings.subsurface != "off" and settings.lobes in ("all", "uniform-diffuse")
    if not is_shown or not material.medium.scatters:
        return NO_SUBSURFACE
    return ALONE if settings.subsurface == "slab" or material.alpha_mode == "blend" else SPREAD


def _is_shown(name: str, lit: bool, common: dict[str, int]) -> bool:
    """Whether the settings show the contribution of a map."""
    if name == "emissive":
        return common["SHOW_EMISSION"] == 1 or not lit
    if name == "occlusion":  # visibility and indirect light replace the occlusion map
        return common["HAS_ENVIRONMENT"] == 1 and common["VISIBILITY"] == common["INDIRECT"] == 0
    return True


def _can_trace_reflections(material: Material) -> bool:
    """Whether any point of its surface may be smooth enough for traced reflections."""
    is_rough = material.metallic_roughness_texture is None and material.perceptual_roughness >= TRACED_ROUGHNESS
    # One ray cannot represent an anisotropic lobe.
    return material.has_interface and not is_rough and not ANISOTROPY.is_on(material)


def _pbr_switches(material: Material, settings: Settings, has_environment: bool) -> dict[str, int]:
    return {
        "REFLECTS": int(material.reflects),
        "GROOVED": 0,
        "WOVEN": int(material.weave is not None),
        **({} if material.weave is None else {"SHADED_SIDE": settings.supersampling}),
        "METALNESS": metalness(material),
        "ROUGH_GLASS": int(material.transmits and material.perceptual_roughness**2 >= DELTA_ALPHA),
        **bsdf_switches(settings),
        "LOOKUPS": has_environment * lookups(material, settings),
        "COAT_LOOKUPS": has_environment * coat_lookups(material, settings),
        "SPECULAR_AA": int(settings.specular_aa == "on"),
        "TRACED_REFRACTION": int(settings.refraction == "traced" and settings.lobes in ("all", "specular")
                                 and material.transmits and material.thickness > 0),
    }


def _phong_switches(material: Material, settings: Settings) -> dict[str, int]:
    shown = bsdf_switches(settings)
    return {"BLINN": int(settings.phong == "blinn-phong"), "HAS_SHININESS": int(material.shininess is not None),
            "SHOW_DIFFUSE": shown["SHOW_DIFFUSE"], "SHOW_SPECULAR": shown["SHOW_SPECULAR"]}
