"""The plan of a path-traced picture: its passes, the switches of their programs, and what was left out and why."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from ..base.counted import counted
from ..plan.bsdf_switches import bsdf_switches, feature_switches_shown
from ..plan.left_out import omitted_features
from ..plan.model import Program
from ..plan.used import feature_lines
from ..plan.warnings import DEEP_GLASS, NO_TRIANGLES
from ..scene.material import DIFFUSE_TRANSMISSION, DISPERSION, SCATTER
from ..scene.scene import Scene
from ..scene.schema import SWITCHED
from ..settings import Settings, setting_choices
from .kinds import BOUNDARY, FIBRE, KINDS, SURFACE, WOVEN, Kind
from .paths.surface_rays import FROM_SURFACE
from .scene.encode import unused_maps
from .scene.geometry import TraceGeometry
from .scene.photons import Photons


@dataclass(frozen=True)
class TracePlan:
    """`programs` has the program of each pass over a wavefront but intersection, by the name of the pass."""

    programs: Mapping[str, Program]
    intersector: str
    triangles: int
    instances: int
    used: tuple[str, ...]
    left_out: tuple[str, ...]
    photons: Mapping[str, Program] = field(default_factory=dict)
    """The programs of each pass over a wavefront of photons; none if there are no photons."""

    @property
    def surfaces(self) -> tuple[str, ...]:
        """The passes that shade surfaces."""
        return tuple(name for name in self.programs if name in {kind.name for kind in KINDS})

    @property
    def media(self) -> tuple[str, ...]:
        """The passes that shade paths between surfaces."""
        return tuple(name for name in self.programs if name in _MEDIA)

    @property
    def has_scattering(self) -> bool:
        """Whether a medium scatters light, so that rays learn what is along their way."""
        return bool(self.programs["generate"]["HAS_SCATTERING"])

    @property
    def has_along(self) -> bool:
        """Whether shadow rays learn how much of their light passes, and not only whether it does."""
        return self.has_scattering or bool(self.programs["generate"]["HAS_PANES"])

    @property
    def has_grids(self) -> bool:
        """Whether there are volumes, through which a pass follows the rays."""
        return "track" in self.programs

    @property
    def state_textures(self) -> int:
        """How many textures the state of a path needs, of those in `viewer.trace.paths.wavefront.STATE`: all if
        surfaces transmit light, so that paths have a medium, or all but that. Without the last two, the shadow ray from
        a vertex begins where the next ray does, since all surfaces are opaque, and no tree of lights asks for a
        normal."""
        on = self.programs["generate"]
        if on["HAS_TRANSMISSION"]:
            return 7
        return 5 + bool(on["HAS_SCATTERING"] or on["HAS_LIGHT_TREE"] or set(self.surfaces) - {SURFACE.name})

    @property
    def chooses_pixels(self) -> bool:
        """Whether pixels get different numbers of samples."""
        return bool(self.programs["begin"]["CHOOSES_PIXELS"])

    @property
    def is_sorted(self) -> bool:
        """Whether paths of one class lie side by side."""
        return bool(self.programs["generate"].get("SORTED"))

    @property
    def knows_classes(self) -> bool:
        """Whether the order of sorted paths tells which pass shades each of them. In media random numbers decide."""
        return self.is_sorted and not self.has_scattering

    @property
    def missing(self) -> tuple[str, ...]:
        """The lines of `left_out` about what the picture lacks, and not about code that it does not need."""
        return tuple(line for line in self.left_out if any(words in line for words in _MISSING))

    def to_json(self) -> dict[str, object]:
        return {
            "passes": ["intersect", *self.programs, *(f"photons: {name}" for name in self.photons), "display"],
            "programs": [{"fragment": p.fragment, "on": {k: v for k, v in p.switches if v}}
                         for p in (*self.programs.values(), *self.photons.values())],
            "intersector": self.intersector,
            "triangles": self.triangles,
            "instances": self.instances,
            "used": list(self.used),
            "left_out": list(self.left_out),
        }


_MISSING = "no path from the camera can hit them", NO_TRIANGLES, DEEP_GLASS
_MEDIA = {"medium": "HAS_SCATTERING", "airlight": "HAS_AIRLIGHT"}
"""The passes between surfaces, and their switches."""
_STATE = ("HAS_TRANSMISSION", "HAS_SCATTERING", "HAS_PANES", "HAS_NESTED", "HAS_GRIDS", "HAS_FOG", "HAS_LIGHT_TREE",
          "HAS_SEE_THROUGH", DISPERSION.switch)
"""Switches of what the state of a path holds."""
_NEUTRAL = ("HAS_ENVIRONMENT", "ENVIRONMENT_ROTATED", "HAS_PUNCTUAL", "LIGHT_RADIUS", "HAS_LIGHTS", "CLAMP")
"""Switches of lights that may be on even if the scene has no such light."""


def plan_trace(
    scene: Scene, settings: Settings, geometry: TraceGeometry, switches: Mapping[str, int], *, intersector: str,
    has_layers: bool, left_out: Sequence[str] = (), rays: int = 0,
    is_background_smooth: bool = False, photons: Photons | None = None, has_sky: bool = False,
    is_sorted: bool = False,
) -> TracePlan:
    """The plan for `scene` under `settings`.

    `switches` are those of the scene's data and lights, `left_out` their lines for the user. `rays` is the kind of rays
    in shaders/trace/surface_ray.glsl, 0 for camera rays. `is_background_smooth` says whether these see the environment
    by B-splines (shaders/trace/background.glsl). `photons` says what photons are aimed at. `has_sky` says that there
    are pixels which no geometry can touch, `is_sorted` that paths are sorted (viewer/trace/paths/arrangement.py).
    """
    sampling = setting_choices()["sampling"].index(settings.sampling)
    switches = dict(switches) | bsdf_switches(settings) | {"SAMPLING": sampling}
    switches = feature_switches_shown(switches, settings)
    shows_emission = settings.lobes == "all"
    for name in ("HAS_EMISSION", "HAS_EMITTERS"):
        switches[name] = int(switches[name] and shows_emission)
    switches["HAS_LIGHTS"] = int(any(switches[name] for name in ("HAS_ENVIRONMENT", "HAS_PUNCTUAL", "HAS_EMITTERS")))
    switches["BACKGROUND"] = (1 + is_background_smooth) * (settings.background == "env" and switches["HAS_ENVIRONMENT"])
    switches["CLAMP"] = int(settings.clamp > 0)
    switches |= {"PHOTONS": 0, "SORTED": int(is_sorted)}
    kinds = {instance.kind for instance in geometry.instances}
    if settings.plan == "everything":
        kinds = {kind for kind in KINDS if kind is not FIBRE and (kind is not BOUNDARY or geometry.scatters)}
        emitters = ["HAS_EMITTERS"] * (shows_emission and not geometry.emitters)
        switches |= dict.fromkeys((*_NEUTRAL, *emitters), 1)
    kinds |= {FIBRE} if geometry.curves is not None else set()
    state = {name: switches[name] for name in (*_STATE, "SORTED")}
    first, chooses = state | {"RAYS": rays}, {"CHOOSES_PIXELS": int(settings.is_adaptive)}
    generate, begins = "trace/generate.frag", first
    if rays == FROM_SURFACE and switches["HAS_EMITTERS"]:
        generate, begins = "trace/generate_lit.frag", switches | first
    sky_names = ("HAS_ENVIRONMENT", "ENVIRONMENT_ROTATED", "BACKGROUND", "CLAMP", "SAMPLING", "HAS_VOLUME")
    sky = {name: switches[name] for name in sky_names}
    classes = state | {name: switches[name] for name in ("HAS_VOLUME", "HAS_AIRLIGHT", "HAS_CURVES", "SAMPLING")}
    programs = {
        **({"sky": Program.of("trace/sky.frag", sky | {"HAS_FOG": 0}),
            "begin sums": Program.of("trace/begin_sums.frag", state | chooses | {"BACKGROUND": switches["BACKGROUND"]}),
            } if has_sky else {}),
        "zero": Program.of("trace/zero.frag", {}),
        "begin": Program.of(generate, begins | chooses | {"BEGINS": 1, "HAS_SKY": int(has_sky)}),
        **({"track": Program.of("trace/track.frag", classes)} if switches["HAS_GRIDS"] else {}),
        **({} if is_sorted and not switches["HAS_SCATTERING"] else {
            "classify": Program.of("trace/classify.frag", classes | {"FIRST_HITS": 0})}),
        "finish": Program.of("trace/finish.frag", first | sky),
        "generate": Program.of(generate, begins | {"BEGINS": 0, "HAS_SKY": 0, "CHOOSES_PIXELS": 0}),
        **{kind.name: Program.of(kind.file, switches | _switches_of(kind, settings, geometry))
           for kind in KINDS if kind in kinds},
        **{name: Program.of(f"trace/{name}.frag", switches) for name, switch in _MEDIA.items() if switches[switch]},
        "idle": Program.of("trace/idle.frag", {}),
        **({} if is_sorted else {"alive": Program.of("trace/alive.frag", state)}),
    }
    if has_layers:
        programs |= {"classify first hits": Program.of("trace/classify.frag", classes | {"FIRST_HITS": 1}),
                     "layers": Program.of("trace/layers.frag", switches)}
        if FIBRE in kinds:
            programs["fibre layers"] = Program.of("trace/fibre_layers.frag", switches)
        if switches["HAS_SCATTERING"]:
            programs["medium layers"] = Program.of("trace/medium_layers.frag", classes)
    has_photons = photons is not None and photons.count > 0
    lines = [*_left_out(scene, settings, geometry, switches, programs, has_layers, photons), *left_out]
    return TracePlan(programs, intersector, geometry.triangle_count, len(geometry.instances),
                     (*_used(geometry, switches), *([photons.description] if photons and has_photons else [])),
                     ("nothing, as requested",) if settings.plan == "everything" else tuple(lines),
                     _photon_programs(programs, switches, classes) if has_photons else {})


def _photon_programs(programs: Mapping[str, Program], switches: Mapping[str, int], classes: Mapping[str, int],
                     ) -> dict[str, Program]:
    """The programs for paths from lights: those of `programs` that change, and the same ones for the rest."""
    light = {"PHOTONS": 1, "HAS_CLEARANCE": 0, "HAS_DEEP_MEDIA": 0,  # they are connected at every collision
             "HAS_CAUSTIC_GUIDE": 0, "SORTED": 0}
    switches, classes = {**switches, "HAS_CAUSTIC_GUIDE": 0, "SORTED": 0}, {**classes, "SORTED": 0}
    first = {name: switches[name] for name in (*_STATE, "LIGHT_RADIUS")}
    shading = {name: Program.of(program.fragment, dict(program.switches) | light)
               for name, program in programs.items() if name in {kind.name for kind in KINDS} | {"medium"}}
    return {
        "begin": Program.of("trace/emit.frag", first | {"BEGINS": 1}),
        **({"track": Program.of("trace/track.frag", classes)} if "track" in programs else {}),
        "classify": Program.of("trace/classify.frag", classes | {"FIRST_HITS": 0, "HAS_AIRLIGHT": 0}),
        "generate": Program.of("trace/emit.frag", first | {"BEGINS": 0}),
        **shading,
        "idle": programs["idle"],
        "alive": programs.get("alive", Program.of("trace/alive.frag", classes)),
        "splat": Program.of("trace/splat.frag", classes),
        "weigh": Program.of("trace/weigh.frag", switches),
    }


def _switches_of(kind: Kind, settings: Settings, geometry: TraceGeometry) -> dict[str, int]:
    """The features that only some kinds of surfaces have: opaque ones let no diffuse light through."""
    materials = [geometry.materials[instance.material] for instance in geometry.instances if instance.kind == kind]
    return {feature.switch: int(settings.plan == "everything" or any(feature.is_on(m.material) for m in materials))
            for feature in (DIFFUSE_TRANSMISSION, SCATTER)}


def _used(geometry: TraceGeometry, switches: Mapping[str, int]) -> tuple[str, ...]:
    count = geometry.triangle_count
    lines = [f"{counted(count, 'triangle')} of {counted(len(geometry.materials), 'material')}"] * bool(count)
    if geometry.curves is not None:
        segments = counted(len(geometry.curves.first), "round segment")
        lines.append(f"{segments} of {counted(geometry.curves.strands, 'strand')}")
    lines += [what for name, what in (*_LIGHTS.items(), *_SURFACES.items()) if switches[name]]
    surfaces = Counter(instance.material for instance in geometry.instances)
    features = {k: geometry.materials[k].features for k in surfaces}
    lines += feature_lines({feature: sum(number for k, number in surfaces.items() if features[k][feature.switch])
                            for feature in SWITCHED if switches.get(feature.switch, 1)})
    lines += [_TREE] * switches["HAS_LIGHT_TREE"]
    if any(instance.kind == WOVEN for instance in geometry.instances):
        lines.append("yarns of woven cloth")
    images = {texture.image for m in geometry.materials
              for texture in (*(use.texture for use in m.color_maps), *m.data_textures)}
    if images:
        lines.append(f"maps from {counted(len(images), 'image')}, about "
                     f"{sum(4 * image.width * image.height for image in images) / 1e6:.3g} MB as pages of one texture")
    return tuple(lines)


def _left_out(
    scene: Scene, settings: Settings, geometry: TraceGeometry, switches: Mapping[str, int],
    programs: Mapping[str, Program], has_layers: bool, photons: Photons | None,
) -> list[str]:
    """Lines for the user: what the scene or the settings made unnecessary, and what is not shown."""
    lines = []
    if geometry.left_out_instances:
        count = geometry.left_out_instances
        lines.append(f"{count} mesh{'es' * (count > 1)}{NO_TRIANGLES}")
    if not (geometry.instances or geometry.has_grids or geometry.fog or geometry.curves):
        return [*lines, "everything but the background: there are no triangles"]
    if not switches["HAS_LIGHTS"]:
        lines.append("shadow rays and light samples: there are no lights")
    else:
        lines += [f"{what}: the scene has none" for name, what in _LIGHTS.items() if not switches[name]]
        if (switches["HAS_PUNCTUAL"] or switches["HAS_EMITTERS"]) and not switches["HAS_LIGHT_TREE"]:
            lines.append(f"{_TREE}: there are few lights, which are chosen by their power")
    if switches["BACKGROUND"] == 0:
        reason = "there is none" if not switches["HAS_ENVIRONMENT"] else "not requested"
        lines.append(f"the environment as background: {reason}")
    lines += [f"{what}: the scene has none" for name, what in _SURFACES.items() if not switches[name]]
    lines += omitted_features(scene, settings)
    lines += unused_maps(scene, geometry)
    lines += [] if photons is None else photons.left_out
    if geometry.depth > geometry.nesting.most:
        most = geometry.nesting.most
        lines.append(f"{DEEP_GLASS}{geometry.depth} deep, but a path can be inside {most} at once: inside more, its "
                     "light is refracted wrongly or lost")
    if geometry.has_grids or geometry.fog is not None:
        lines.append("finishing empty pixels early: volumes or fog may be anywhere")
    if not has_layers:
        lines.append("the pass for layers (albedo, normal): not requested")
    if not switches["CLAMP"]:
        lines.append("the clamp on indirect light: not requested")
    return lines


_TREE = "a tree that chooses lights by their positions"
_LIGHTS = {
    "HAS_ENVIRONMENT": "light from an environment",
    "HAS_PUNCTUAL": "light from point, spot or directional lights",
    "HAS_EMITTERS": "light from emissive triangles",
}
_SURFACES = {
    "HAS_TEXTURES": "textures",
    "HAS_NORMAL_MAP": "normal maps",
    "HAS_COLOR": "vertex colours",
    "HAS_SEE_THROUGH": "transparency by alpha",
    "HAS_PANES": "shadow rays through thin smooth panes",
    "HAS_NESTED": "solids of glass that touch or overlap",
    "HAS_UNLIT": "unlit materials",
    "HAS_VOLUME": "absorption in volumes",
    "HAS_SCATTERING": "scattering in volumes",
    "HAS_GRIDS": "volumes (grids of densities)",
    "HAS_FOG": "fog",
    "HAS_CURVES": "curves",
    "HAS_DROPLETS": "droplets of water",
    "HAS_CAUSTIC_GUIDE": "a guide to caustics of lamps",
}
