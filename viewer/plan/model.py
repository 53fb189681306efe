"""The data of a plan: draws, their shader programs, lights and passes."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING

from ..scene.light import Light
from ..scene.material import Material

if TYPE_CHECKING:
    from .curves import CurvePlan
    from .media import MediaPlan

LAYERS_LEFT_OUT = "the pass for layers (--aov): not requested"
"""The line of `Plan.left_out` for it."""
THIN_WALLED, SOLID = 1, 2
"""Values of `Draw.transmits`; 0: opaque."""
NO_SUBSURFACE, ALONE, GATHERED, SPREAD = range(4)
"""Values of the switch SUBSURFACE: light that a solid scatters inside is not drawn; found at each point alone; found
for a pass that spreads it over the surface; or taken from that pass."""


@dataclass(frozen=True)
class Program:
    """A shader program, given by its fragment file and switches. The switches are sorted, so equal programs compare
    equal."""

    fragment: str
    switches: tuple[tuple[str, int], ...]

    @classmethod
    def of(cls, fragment: str, switches: Mapping[str, int]) -> Program:
        return cls(fragment, tuple(sorted(switches.items())))

    def __getitem__(self, name: str) -> int:
        return self._values[name]

    def get(self, name: str) -> int:
        """The value of a switch; 0 if the program does not have it."""
        return self._values.get(name, 0)

    @cached_property
    def _values(self) -> dict[str, int]:
        return dict(self.switches)


@dataclass(frozen=True)
class Draw:
    """One instance, or many of one mesh, with the material, program, maps and attributes that they are drawn with.

    `material` is the index of its material in the scene, and `surface` that material with maps of one colour folded
    into its factors. `maps` are the maps that its program samples. `blank_maps` are maps that a shared program samples
    but the material does not have; a neutral texture is bound for them.
    """

    instance: int
    mesh: int
    material: int
    surface: Material
    program: Program
    maps: tuple[str, ...]
    attributes: tuple[str, ...]
    alpha_mode: str
    transmits: int
    blank_maps: tuple[str, ...] = ()
    is_pane: bool = False
    """Whether lamps shine straight through, as shadow maps show it."""
    given_up: tuple[str, ...] = ()
    """Switches, those of maps among them, that are off because the program would sample too many textures."""
    instances: tuple[int, ...] = ()
    """All instances that one call draws, of which `instance` is the first; empty where it is the only one."""

    @property
    def hides_sky(self) -> bool:
        """Whether the light of the environment does not pass it."""
        return not self.transmits or not self.surface.is_seen_through

    @property
    def uses_visibility(self) -> bool:
        """Whether the environment's light on it is multiplied by the visibility, which an earlier pass computes."""
        return self.program.get("VISIBILITY") == 1

    @property
    def traces_reflections(self) -> bool:
        """Whether it reflects the model, by rays that an earlier pass traces."""
        return self.program.get("TRACED_REFLECTION") == 1

    @property
    def traces_refraction(self) -> bool:
        """Whether earlier passes trace paths through the model for the light that it transmits."""
        return self.program.get("TRACED_REFRACTION") == 1

    @property
    def has_subsurface(self) -> bool:
        """Whether light that is scattered inside of it is drawn."""
        return self.program.get("SUBSURFACE") != NO_SUBSURFACE

    @property
    def spreads_subsurface(self) -> bool:
        """Whether an earlier pass spreads that light over its surface."""
        return self.program.get("SUBSURFACE") == SPREAD

    @property
    def is_deferred(self) -> bool:
        """Whether it is shaded once its triangles and all others are drawn."""
        return self.program.get("DEFERRED") == 1

    @property
    def has_gaps(self) -> bool:
        """Whether it is cloth between whose yarns something shows: it blends, but hides nearly all behind it."""
        return self.program.get("WOVEN") == 1 and self.alpha_mode == "blend"

    @property
    def is_in_gbuffer(self) -> bool:
        """Whether it or a pass needs its position and normal before it is shaded."""
        return self.uses_visibility or self.traces_reflections or self.has_gaps


@dataclass(frozen=True)
class Plan:
    """Everything that is drawn in a frame.

    `lights` are in the order that the shaders expect. `shadow_layers` has the first shadow map layer of each light, or
    -1. `used`, `left_out` and `saved` explain the plan; see viewer/plan/explain.py.
    """

    draws: tuple[Draw, ...]
    lights: tuple[Light, ...]
    shadow_layers: tuple[int, ...]
    shadow_layer_count: int
    environment: bool
    reflections: bool
    ambient: bool
    dfg: bool
    environment_shadows: int
    """The number of directional lights sampled from the environment for its shadows; 0: no shadows."""
    ambient_occlusion: bool
    estimates_indirect: bool
    """Whether what hides a light of the environment reflects as the mean of all surfaces."""
    background: bool
    background_blur: float
    """In degrees; 0: none."""
    ground: Program | None = None
    """What draws the shadow of the model on the ground; None without it."""
    media: MediaPlan | None = None
    """How fog is drawn; None without any."""
    curves: CurvePlan | None = None
    """How curves are drawn; None without any."""
    counts: bool = False
    """Whether the fragments that are drawn are counted, in the order of `draws`."""
    wireframe: bool = False
    """Whether the edges of triangles are drawn over the picture."""
    grid: bool = False
    """Whether a grid on the ground and the axes of the world are drawn."""
    photons: bool = False
    """Whether it is photons that bring the light of the scene's lamps through panes, in its colour."""
    used: tuple[str, ...] = ()
    left_out: tuple[str, ...] = ()
    saved: Mapping[str, float] = field(default_factory=dict)
    is_everything: bool = False

    @cached_property
    def kinds(self) -> tuple[Draw, ...]:
        """One draw of each mesh: those of its other instances are alike, and there may be a hundred thousand."""
        return tuple({draw.mesh: draw for draw in self.draws}.values())

    @cached_property
    def _counts(self) -> Counter[int]:
        counts: Counter[int] = Counter()
        for draw in self.draws:
            counts[draw.mesh] += len(draw.instances) or 1
        return counts

    def count(self, draw: Draw) -> int:
        """How many instances are drawn like this one of `kinds`."""
        return self._counts[draw.mesh]

    @property
    def stretches(self) -> bool:
        """Whether anisotropy stretches the highlights of any surface."""
        return any(program.get("ANISOTROPIC") for program in self.programs)

    @property
    def programs(self) -> tuple[Program, ...]:
        return tuple(dict.fromkeys(draw.program for draw in self.kinds))

    @property
    def has_blended(self) -> bool:
        return self.is_everything or any(draw.alpha_mode == "blend" for draw in self.kinds)

    @property
    def has_deferred(self) -> bool:
        """Whether some surfaces are shaded once all triangles are drawn."""
        return any(draw.is_deferred for draw in self.kinds)

    @property
    def has_surfaces(self) -> bool:
        """Whether there are other surfaces."""
        return any(not draw.is_deferred for draw in self.kinds)

    @property
    def is_over_layers(self) -> bool:
        """Whether what lies behind all surfaces can be drawn once a pixel, too. So it is where no solid looks at the
        picture behind it without a background, and all else that is drawn is within the boxes of meshes."""
        are_known = not any(draw.transmits == SOLID or draw.program.get("IS_POINTS") for draw in self.kinds)
        return (self.has_deferred and are_known and self.curves is None
                and not (self.wireframe or self.grid or self.counts))

    @property
    def fills_behind(self) -> bool:
        """Whether a background or media are drawn in all pixels without a surface."""
        return self.background or self.media is not None

    @property
    def has_behind(self) -> bool:
        """Whether anything is drawn there."""
        return self.fills_behind or self.ground is not None

    @property
    def has_visibility(self) -> bool:
        """Whether a pass computes the visibility of the environment before the surfaces are shaded."""
        return any(draw.uses_visibility for draw in self.kinds)

    def uses_visibility(self, has_gaps: bool) -> bool:
        """Whether it is computed for cloth with gaps, or for other surfaces."""
        return any(draw.uses_visibility and draw.has_gaps == has_gaps for draw in self.kinds)

    @property
    def has_gaps(self) -> bool:
        """Whether something shows between the yarns of cloth."""
        return any(draw.has_gaps for draw in self.kinds)

    @property
    def tints_sky(self) -> bool:
        """Whether shadows of the environment show what its light keeps on its way through glass."""
        return self.environment_shadows > 0 and any(not draw.hides_sky for draw in self.kinds)

    @property
    def has_traced_reflections(self) -> bool:
        """Whether a pass traces reflections of the model."""
        return any(draw.traces_reflections for draw in self.kinds)

    @property
    def has_traced_refraction(self) -> bool:
        """Whether a pass traces paths through solid glass."""
        return any(draw.traces_refraction for draw in self.kinds)

    @property
    def has_dispersion(self) -> bool:
        """Whether red, green and blue take paths of their own through solid glass."""
        return any(draw.traces_refraction and draw.program["DISPERSIVE"] for draw in self.kinds)

    @property
    def has_indirect(self) -> bool:
        """Whether surfaces are lit by indirect light that is baked at their vertices."""
        return any(draw.program.get("INDIRECT") for draw in self.kinds)

    @property
    def has_subsurface(self) -> bool:
        """Whether solids show light that is scattered inside of them."""
        return any(draw.has_subsurface for draw in self.kinds)

    @property
    def spreads_subsurface(self) -> bool:
        """Whether a pass spreads that light over their surfaces."""
        return any(draw.spreads_subsurface for draw in self.kinds)

    @property
    def has_solid_transmission(self) -> bool:
        """Whether a surface is the boundary of a solid, into which light is refracted (KHR_materials_volume)."""
        return self.is_everything or any(draw.transmits == SOLID for draw in self.kinds)

    @property
    def has_thin_transmission(self) -> bool:
        """Whether a surface transmits light as a thin wall, without refraction."""
        return self.is_everything or any(draw.transmits == THIN_WALLED for draw in self.kinds)

    def to_json(self) -> dict[str, object]:
        passes = ["shadows"] * bool(self.shadow_layer_count) + ["visibility"] * self.has_visibility
        passes += ["reflections"] * self.has_traced_reflections
        passes += ["media"] * (self.media is not None)
        passes += ["subsurface"] * self.spreads_subsurface
        passes += ["deferred surfaces"] * self.has_deferred
        passes += ["surfaces"] * self.has_surfaces
        passes += ["curves"] * (self.curves is not None)
        passes += ["solid transmission"] if self.has_solid_transmission else []
        passes += ["background"] if self.background else []
        passes += ["ground"] * (self.ground is not None)
        passes += ["media without background"] * (self.media is not None and not self.background)
        passes += ["thin-walled transmission"] if self.has_thin_transmission else []
        passes += ["blend"] if self.has_blended else []
        passes = ["overdraw"] if self.counts else passes
        passes += ["wireframe"] * self.wireframe + ["grid"] * self.grid
        return {
            "passes": [*passes, "display"],
            "programs": [{"fragment": p.fragment, "on": {k: v for k, v in p.switches if v}}
                         for p in (*self.programs, *(self.curves.programs if self.curves is not None else ()),
                                   *((self.ground,) if self.ground is not None else ()))],
            "draws": len(self.draws),
            "maps": sorted({f"{draw.material}:{name}" for draw in self.kinds for name in draw.maps}),
            "lights": len(self.lights),
            "shadow_layers": self.shadow_layer_count,
            "used": list(self.used),
            "left_out": list(self.left_out),
            "saved": dict(self.saved),
        }
