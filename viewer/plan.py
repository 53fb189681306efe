"""What of a scene is needed to show it: the exact programs, textures and passes, and what was left out and why.

The plan is made from scene and settings before anything is compiled or uploaded. A shader program is a fragment file
plus a set of switches; nothing is in it that the mesh, its material, the lights and the settings do not ask for.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from .errors import UsageError
from .scene.light import Light
from .scene.material import Material, Texture
from .scene.mesh import Mesh
from .scene.scene import Scene
from .settings import Settings

MAX_LIGHTS = 128
"""What a uniform block of 16 KiB, the least OpenGL 3.3 grants, holds with room to spare."""
MAX_SHADOW_LAYERS = 24

# Maps in the order of their texture units: the material's field, and whether its colours are sRGB.
MAPS = {
    "base_color": True,
    "metallic_roughness": False,
    "normal": False,
    "occlusion": False,
    "emissive": True,
    "specular": False,
    "specular_color": True,
    "transmission": False,
    "thickness": False,
}

_NDF = ("ggx", "beckmann", "blinn-phong")
_MASKING = ("smith", "smith-separable", "v-cavity", "none")
_ALPHA_MODES = ("opaque", "mask", "blend")


@dataclass(frozen=True)
class Program:
    """A shader program: its fragment file and its switches, sorted, so that equal programs compare equal."""

    fragment: str
    switches: tuple[tuple[str, int], ...]

    def __getitem__(self, name: str) -> int:
        return dict(self.switches)[name]


@dataclass(frozen=True)
class Draw:
    """One instance and what it is drawn with; `maps` are the material's maps that its program samples."""

    instance: int
    mesh: int
    material: int
    program: Program
    maps: tuple[str, ...]
    attributes: tuple[str, ...]
    alpha_mode: str
    transmits: bool


@dataclass(frozen=True)
class Plan:
    """`lights` are in the order the shaders expect; `shadow_layers` has each one's first layer or -1."""

    draws: tuple[Draw, ...]
    lights: tuple[Light, ...]
    shadow_layers: tuple[int, ...]
    shadow_layer_count: int
    environment: bool
    reflections: bool
    ambient: bool
    dfg: bool
    background: bool
    left_out: tuple[str, ...]

    @property
    def programs(self) -> tuple[Program, ...]:
        return tuple(dict.fromkeys(draw.program for draw in self.draws))

    @property
    def has_blended(self) -> bool:
        return any(draw.alpha_mode == "blend" for draw in self.draws)

    @property
    def has_transmission(self) -> bool:
        return any(draw.transmits for draw in self.draws)

    def to_json(self) -> dict[str, object]:
        passes = (["shadows"] if self.shadow_layer_count else []) + (["surfaces"] if self.draws else [])
        passes += ["background"] if self.background else []
        passes += ["transmission"] if self.has_transmission else []
        passes += ["blend"] if self.has_blended else []
        return {
            "passes": [*passes, "display"],
            "programs": [{"fragment": p.fragment, "on": {k: v for k, v in p.switches if v}} for p in self.programs],
            "draws": len(self.draws),
            "maps": sorted({f"{draw.material}:{name}" for draw in self.draws for name in draw.maps}),
            "lights": len(self.lights),
            "shadow_layers": self.shadow_layer_count,
            "left_out": list(self.left_out),
        }


def is_lit(mesh: Mesh, material: Material) -> bool:
    """Lines and points without normals are not shaded (glTF 2.0, section 3.7.2.1), nor are unlit materials."""
    return mesh.normals is not None and not material.unlit


def is_dark(scene: Scene) -> bool:
    """Whether no light falls on anything and nothing shines by itself: the picture will be black."""
    if scene.environment is not None and scene.environment.intensity > 0:
        return False
    if not scene.instances or any(light.intensity * max(light.color) > 0 for light in scene.lights):
        return False
    meshes = (scene.meshes[instance.mesh] for instance in scene.instances)
    shown = ((mesh, scene.materials[mesh.material]) for mesh in meshes)
    return not any(any(material.emissive) or not is_lit(mesh, material) for mesh, material in shown)


def environment_use(scene: Scene, settings: Settings) -> tuple[bool, bool]:
    """Whether the environment lights any surface, and whether any reflects it, which takes its filtered levels."""
    if scene.environment is None:
        return False, False
    meshes = (scene.meshes[instance.mesh] for instance in scene.instances)
    lit = [material for mesh in meshes if is_lit(mesh, material := scene.materials[mesh.material])]
    shows = settings.mode == "pbr" and settings.lobes in ("all", "specular")
    return bool(lit), shows and any(map(reflects, lit))


def reflects(material: Material) -> bool:
    """Whether the surface has an interface that reflects or refracts; else it is Lambertian."""
    return material.specular > 0 or material.metallic > 0 or _transmits(material)


def plan_scene(
    scene: Scene, settings: Settings, lights: Sequence[Light], *, samples: int, half_target: bool, orthographic: bool
) -> Plan:
    """The plan for `scene` under `settings`.

    `lights` are all there are, those taken out of the environment included; `samples` the multisampling the target
    has; `half_target` whether it holds half floats. Raises UsageError for mode path, which is not the raster's.
    """
    if settings.mode == "path":
        raise UsageError("mode path is not the raster's to draw")
    lit = [is_lit(scene.meshes[i.mesh], scene.materials[scene.meshes[i.mesh].material]) for i in scene.instances]
    shown_lights = _ordered_lights(lights) if any(lit) else ()
    layers, layer_count = _shadow_layers(shown_lights, settings)
    environment, reflections = environment_use(scene, settings)
    common = {
        "HALF_TARGET": int(half_target),
        "SAMPLES": samples,
        "IS_ORTHOGRAPHIC": int(orthographic),
        "LIGHT_COUNT": len(shown_lights),
        "DIRECTIONAL_COUNT": sum(light.kind == "directional" for light in shown_lights),
        "POINT_COUNT": sum(light.kind == "point" for light in shown_lights),
        "SHADOW_LAYERS": layer_count,
        "HAS_ENVIRONMENT": int(environment),
        "ENVIRONMENT_ROTATED": int(environment and scene.environment.rotation != 0),
        "SHOW_EMISSION": int(settings.lobes == "all"),
        "SHOW_DIFFUSE": int(settings.lobes in ("all", "uniform-diffuse")),
        "SHOW_SPECULAR": int(settings.lobes in ("all", "specular")),
    }
    draws = tuple(
        _draw(index, instance.mesh, scene.meshes[instance.mesh], scene.materials, settings, common)
        for index, instance in enumerate(scene.instances)
    )
    return Plan(
        draws=draws,
        lights=shown_lights,
        shadow_layers=layers,
        shadow_layer_count=layer_count,
        environment=environment and settings.mode == "pbr",
        reflections=reflections,
        ambient=environment and settings.mode == "phong",
        dfg=any(draw.program.fragment == "raster/pbr.frag" and draw.program["REFLECTS"] for draw in draws),
        background=settings.background == "env" and scene.environment is not None,
        left_out=tuple(_left_out(scene, settings, draws, any(lit), shown_lights, layer_count)),
    )


def _ordered_lights(lights: Sequence[Light]) -> tuple[Light, ...]:
    """Directional, point, spot; unlit ones dropped; beyond MAX_LIGHTS the brightest stay."""
    bright = [light for light in lights if light.intensity * max(light.color) > 0]
    if len(bright) > MAX_LIGHTS:
        bright = sorted(bright, key=lambda light: -light.intensity * max(light.color))[:MAX_LIGHTS]
    order = ("directional", "point", "spot")
    return tuple(sorted(bright, key=lambda light: order.index(light.kind)))


def _shadow_layers(lights: Sequence[Light], settings: Settings) -> tuple[tuple[int, ...], int]:
    """First shadow layer of each light, -1 for those that get none, and how many layers there are."""
    first, used = [], 0
    for light in lights:
        needed = 6 if light.kind == "point" else 1
        if settings.shadows == "on" and light.casts_shadow and used + needed <= MAX_SHADOW_LAYERS:
            first.append(used)
            used += needed
        else:
            first.append(-1)
    return tuple(first), used


def _draw(
    index: int, mesh_index: int, mesh: Mesh, materials: Sequence[Material], settings: Settings, common: dict[str, int]
) -> Draw:
    material = materials[mesh.material]
    lit = is_lit(mesh, material)
    maps = tuple(name for name in MAPS if _samples(name, mesh, material, settings, lit, common))
    textures = {name: material_map(material, name) for name in maps}
    uv_sets = sum(1 << uv_set for uv_set in {texture.uv_set for texture in textures.values()})
    normal_mapped = "normal" in maps
    switches = {
        "ALPHA_MODE": _ALPHA_MODES.index(material.alpha_mode),
        "HAS_COLOR": int(mesh.colors is not None),
        "HAS_EMISSIVE": int(any(material.emissive)),
        "IS_POINTS": int(mesh.topology == "points"),
        "UV_SETS": uv_sets,
        "HAS_NORMAL": int(lit),
        "HAS_TANGENT": int(normal_mapped),
        **{name: common[name] for name in ("HALF_TARGET", "SAMPLES")},
    }
    for name in MAPS:
        texture = textures.get(name)
        macro = name.upper()
        switches[f"{macro}_MAP"] = int(texture is not None)
        switches[f"{macro}_UV"] = texture.uv_set if texture else 0
        switches[f"{macro}_TRANSFORM"] = int(texture is not None and texture.transform is not None)
        switches[f"{macro}_MIRROR"] = _mirror(texture)
    fragment = "raster/unlit.frag"
    if lit:
        fragment = f"raster/{settings.mode}.frag"
        switches |= common | {"DOUBLE_SIDED": int(material.double_sided)}
        switches |= _pbr_switches(material, settings) if settings.mode == "pbr" else _phong_switches(material, settings)
    attributes = ["a_position"]
    attributes += ["a_normal"] * lit + ["a_tangent"] * normal_mapped + ["a_color"] * (mesh.colors is not None)
    attributes += [f"a_uv{k}" for k in range(2) if uv_sets >> k & 1]
    program = Program(fragment, tuple(sorted(switches.items())))
    transmits = switches.get("TRANSMISSION", 0) > 0
    return Draw(index, mesh_index, mesh.material, program, maps, tuple(attributes), material.alpha_mode, transmits)


def _pbr_switches(material: Material, settings: Settings) -> dict[str, int]:
    varies = material.metallic_roughness_texture is not None or 0 < material.metallic < 1
    tinted = material.specular_color_texture is not None or material.specular_color != (1.0, 1.0, 1.0)
    return {
        "REFLECTS": int(reflects(material)),
        "SPECULAR_TINTED": int(tinted),
        "METALNESS": 0 if material.metallic == 0 else 2 if varies else 1,
        "NDF": _NDF.index(settings.ndf),
        "MASKING": _MASKING.index(settings.masking),
        "FRESNEL": int(settings.fresnel == "exact"),
        "MULTISCATTER": int(settings.multiscatter == "on"),
        "SHOW_MULTISCATTER": int(settings.lobes in ("all", "directional-diffuse")),
        "SPECULAR_AA": int(settings.specular_aa == "on"),
        "TRANSMISSION": 0 if not _transmits(material) else 1 if material.thickness == 0 else 2,
    }


def _transmits(material: Material) -> bool:
    """Whether light passes. Metals let none through, and what has ior 0 reflects all."""
    is_metal = material.metallic == 1 and material.metallic_roughness_texture is None
    return material.transmission > 0 and not is_metal and material.ior >= 1


def _phong_switches(material: Material, settings: Settings) -> dict[str, int]:
    return {"BLINN": int(settings.phong == "blinn-phong"), "HAS_SHININESS": int(material.shininess is not None)}


def material_map(material: Material, name: str) -> Texture | None:
    return getattr(material, f"{name}_texture")


def _samples(
    name: str, mesh: Mesh, material: Material, settings: Settings, lit: bool, common: dict[str, int]
) -> bool:
    """Whether a map of the material changes any pixel of this mesh."""
    texture = material_map(material, name)
    if texture is None or texture.uv_set >= len(mesh.uvs):
        return False
    dielectric = settings.mode == "pbr" and lit and (material.metallic < 1 or material.metallic_roughness_texture)
    return {
        "base_color": True,
        "emissive": any(material.emissive) and (common["SHOW_EMISSION"] == 1 or not lit),
        "metallic_roughness": lit and (material.metallic > 0 or material.perceptual_roughness > 0 and reflects(material)),
        "normal": lit and mesh.tangents is not None and material.normal_scale != 0,
        "occlusion": lit and material.occlusion_strength > 0 and common["HAS_ENVIRONMENT"] == 1,
        "specular": bool(dielectric) and material.specular > 0,
        "specular_color": bool(dielectric) and material.specular > 0 and any(material.specular_color),
        "transmission": bool(dielectric) and _transmits(material),
        "thickness": bool(dielectric) and _transmits(material) and material.thickness > 0,
    }[name]


def _mirror(texture: Texture | None) -> int:
    """Bit 0: mirrored along s, bit 1: along t (done in the shader)."""
    if texture is None:
        return 0
    return (texture.sampler.wrap_s == "mirror") | (texture.sampler.wrap_t == "mirror") << 1


def _left_out(
    scene: Scene, settings: Settings, draws: Sequence[Draw], any_lit: bool, lights: Sequence[Light], layers: int
) -> list[str]:
    """In words, what the scene or the settings made unnecessary."""
    lines = []
    if not scene.instances:
        return ["everything but the background: nothing is in the scene"]
    if not any_lit:
        lines.append("all lighting: every surface is unlit")
    elif scene.environment is None:
        lines.append("image-based light, its bake and textures: there is no environment")
    elif settings.mode == "phong":
        lines.append("prefiltered environment and DFG table: Phong has no use for them")
    if any_lit and not lights:
        lines.append("code for point, spot and directional lights: there are none")
    if lights and not layers:
        lines.append("shadow maps: " + ("switched off" if settings.shadows == "off" else "no light casts any"))
    for kind in ("directional", "point", "spot"):
        if lights and not any(light.kind == kind for light in lights):
            lines.append(f"code for {kind} lights: there are none")
    if settings.background != "env" or scene.environment is None:
        reason = "there is none" if scene.environment is None else "not asked for"
        lines.append(f"the environment as background: {reason}")
    if not any(draw.alpha_mode == "blend" for draw in draws):
        lines.append("the sorted pass for blending: nothing is see-through")
    if not any(draw.transmits for draw in draws):
        is_glass = settings.mode == "phong" and any(map(_transmits, scene.materials))
        reason = "to Phong glass is opaque" if is_glass else "nothing transmits light"
        lines.append(f"the picture behind glass and its blurred levels: {reason}")
    if not any("a_tangent" in draw.attributes for draw in draws):
        lines.append("tangents: there are no normal maps")
    sampled = {(draw.material, name) for draw in draws for name in draw.maps}
    idle = sum(1 for k, m in enumerate(scene.materials) for n in MAPS if material_map(m, n) and (k, n) not in sampled)
    if idle:
        lines.append(f"{idle} material map{'s' * (idle > 1)}, not decoded: no pixel depends on them")
    return lines
