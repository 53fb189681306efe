"""Plans of views: one quantity of the surfaces in place of their shading (docs/views.md)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields, replace

from ..material.fold import without_constant_maps
from ..material.use import feature_switches, supported, used_maps
from ..scene.material import SPECULAR_GLOSSINESS, Material
from ..scene.mesh import Mesh
from ..scene.scene import Scene
from ..scene.schema import MAPS, no_switches
from ..settings import VALUES, Settings
from .curves import CurvePlan, plan_curves
from .instances import instances_of, is_instanced, placed
from .map_switches import ALPHA_MODES, map_switches
from .model import SOLID, THIN_WALLED, Draw, Plan, Program
from .sharing import attributes_of
from .used import used_lines

_MAPS = {"base-color": ("base_color", "specular_glossiness"), "normal": ("normal",),
         "roughness": ("metallic_roughness", "specular_glossiness"), "metalness": ("metallic_roughness",)}
"""The maps that each view reads, beside that of alpha."""
_KEPT = ("show", "antialias", "curve_radius",
         *(f.name for f in fields(Settings) if f.name.startswith("hair_") and f.name != "hair_scattering"))
_UNLIT = ("LIGHT_COUNT", "DIRECTIONAL_COUNT", "POINT_COUNT", "SHADOW_LAYERS", "SHADOW_PATTERN", "HAS_ENVIRONMENT",
          "ENVIRONMENT_ROTATED", "MEDIA", "FOG", "FOG_HEIGHT", "VOLUMES")


def view_settings(settings: Settings) -> Settings:
    """The settings by which a view is drawn: those that change it, and the defaults of what only light needs.

    Settings that show shading are returned as they are.
    """
    if not settings.shows_values:
        return settings
    if settings.show == "overdraw":  # all that decides what is drawn, and in which order
        return replace(settings, background="none", antialias="none", caustics="off", fog=0.0, grid="off")
    return replace(Settings(mode="phong", background="none"), **{name: getattr(settings, name) for name in _KEPT})


def plan_view(scene: Scene, settings: Settings, shaded: Plan | None, *, samples: int, half_target: bool,
              orthographic: bool) -> Plan:
    """The plan of the view `settings.show`; the arguments are those of `plan_scene`. `shaded` is the plan of the shaded
    picture, for counting what it draws."""
    settings = view_settings(settings)
    common = {"HALF_TARGET": int(half_target), "SAMPLES": samples, "MEDIA": 0, "INDIRECT": 0, "SUBSURFACE": 0,
              "IS_ORTHOGRAPHIC": int(orthographic), "SHOW": VALUES.index(settings.show)}
    instances = instances_of(scene)
    alike = {k: _draw(k, scene.meshes[k], scene, settings, common, len(numbers)) for k, numbers in instances.items()}
    draws = placed(alike, instances) if shaded is None else _in_order(alike, shaded)
    plan = Plan(
        draws=draws, counts=shaded is not None,
        lights=(), shadow_layers=(), shadow_layer_count=0, environment=False, reflections=False, ambient=False,
        dfg=False, environment_shadows=0, ambient_occlusion=False, estimates_indirect=False, background=False,
        background_blur=0.0, curves=_curves(scene, settings, common))
    left_out = [f"lights, the environment, shadows and all shading: the view {settings.show} has none"]
    if scene.volumes:
        left_out.append(f"volumes: the view {settings.show} is of surfaces")
    return replace(plan, used=used_lines(plan), left_out=tuple(left_out))


def _in_order(alike: Mapping[int, Draw], shaded: Plan) -> tuple[Draw, ...]:
    """Draws of instances as the passes of `shaded` have them: opaque surfaces, solid and thin-walled glass, what
    blends. `alike` has one of each mesh."""
    order = {program: k for k, program in enumerate(shaded.programs)}
    real = [replace(
        draw := alike[other.mesh], instance=other.instance, instances=other.instances, alpha_mode=other.alpha_mode,
        transmits=other.transmits, surface=other.surface, program=Program.of(draw.program.fragment, {
            **dict(draw.program.switches), "INSTANCED": other.program["INSTANCED"]})) for other in shaded.draws]
    places = [(draw.alpha_mode == "blend", (0, SOLID, THIN_WALLED).index(draw.transmits), order[draw.program],
               draw.material) for draw in shaded.draws]
    return tuple(real[k] for k in sorted(range(len(real)), key=places.__getitem__))


def _draw(mesh_index: int, mesh: Mesh, scene: Scene, settings: Settings, common: dict[str, int], count: int) -> Draw:
    material = supported(without_constant_maps(scene.materials[mesh.material]), mesh)
    material = material if settings.show == "overdraw" else _cut_out(material)
    wanted = set(_MAPS.get(settings.show, ())) | ({"base_color"} if material.alpha_mode == "mask" else set())
    maps = tuple(name for name in used_maps(material, mesh, "pbr") if name in wanted)
    textures = {name: texture for name in maps if (texture := MAPS[name].texture(material))}
    needs_uv = settings.show == "uv" and len(mesh.uvs) > 0
    features = feature_switches(material, "pbr") if "specular_glossiness" in wanted else {}
    switches = no_switches() | common | {
        "ALPHA_MODE": ALPHA_MODES.index(material.alpha_mode),
        "DOUBLE_SIDED": int(material.double_sided),
        "HAS_COLOR": int(mesh.colors is not None),
        "HAS_NORMAL": int(mesh.normals is not None),
        "HAS_TANGENT": int("normal" in maps),
        "IS_POINTS": int(mesh.topology == "points"),
        "INSTANCED": int(is_instanced(count, material, common)),
        "IS_FLAT": int(mesh.topology == "triangles"),
        "UV_SETS": sum(1 << uv_set for uv_set in {texture.uv_set for texture in textures.values()}) | int(needs_uv),
        SPECULAR_GLOSSINESS.switch: features.get(SPECULAR_GLOSSINESS.switch, 0),
    }
    for name in MAPS:
        switches |= map_switches(name.upper(), textures.get(name))
    return Draw(0, mesh_index, mesh.material, material, Program.of("raster/view.frag", switches), maps,
                attributes_of(switches), material.alpha_mode, 0)


def _cut_out(material: Material) -> Material:
    """`material` as a view shows it, which has one surface in a pixel: what blends is there where it hides half of what
    is behind it or more."""
    if material.alpha_mode == "blend":
        return replace(material, alpha_mode="mask", alpha_cutoff=0.5)
    return material


def _curves(scene: Scene, settings: Settings, common: dict[str, int]) -> CurvePlan | None:
    unlit = dict.fromkeys(_UNLIT, 0)
    plan = plan_curves(scene, settings, common | unlit)
    if plan is None:
        return None
    shade = tuple(Program.of("raster/curve_view.frag", {
        name: value for name, value in program.switches if name not in ("SHOW_DIFFUSE", "SHOW_SPECULAR")}
        | {"SHOW": common["SHOW"]}) for program in plan.shade)
    return replace(plan, shade=shade)
