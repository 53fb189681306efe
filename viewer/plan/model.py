"""What a plan says: draws, their programs, lights and passes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from ..scene.light import Light
from ..scene.material import Material


@dataclass(frozen=True)
class Program:
    """A shader program: its fragment file and its switches, sorted, so that equal programs compare equal."""

    fragment: str
    switches: tuple[tuple[str, int], ...]

    def __getitem__(self, name: str) -> int:
        return dict(self.switches)[name]


@dataclass(frozen=True)
class Draw:
    """One instance and what it is drawn with.

    `surface` is its material, number `material` in the scene, with maps of one colour taken into its factors; `maps`
    are those that its program samples, `blank_maps` those for which it samples white instead.
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

    @property
    def sees_visibility(self) -> bool:
        """Whether it is shaded by what of the environment is not hidden."""
        return dict(self.program.switches).get("VISIBILITY", 0) == 1

    @property
    def is_traced(self) -> bool:
        """Whether it is shaded by what rays from it meet of the model."""
        return dict(self.program.switches).get("TRACED", 0) == 1

    @property
    def is_traced_body(self) -> bool:
        """Whether paths find what light comes through it."""
        return dict(self.program.switches).get("TRACED_BODIES", 0) == 1

    @property
    def is_in_gbuffer(self) -> bool:
        """Whether passes before the surfaces are shaded look from it."""
        return self.sees_visibility or self.is_traced


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
    environment_shadows: int
    """Lights drawn from the environment for its shadows; 0: none."""
    ambient_occlusion: bool
    background: bool
    used: tuple[str, ...] = ()
    left_out: tuple[str, ...] = ()
    saved: Mapping[str, float] = field(default_factory=dict)
    is_everything: bool = False

    @property
    def programs(self) -> tuple[Program, ...]:
        return tuple(dict.fromkeys(draw.program for draw in self.draws))

    @property
    def has_blended(self) -> bool:
        return self.is_everything or any(draw.alpha_mode == "blend" for draw in self.draws)

    @property
    def has_visibility(self) -> bool:
        """Whether it is found, before surfaces are shaded, how much of the environment each pixel sees."""
        return any(draw.sees_visibility for draw in self.draws)

    @property
    def has_traced(self) -> bool:
        """Whether rays find what surfaces mirror of the model."""
        return any(draw.is_traced for draw in self.draws)

    @property
    def has_traced_bodies(self) -> bool:
        """Whether paths find what light comes through bodies of glass."""
        return any(draw.is_traced_body for draw in self.draws)

    @property
    def has_indirect(self) -> bool:
        """Whether surfaces are shaded by the light of others, found at their vertices."""
        return any(dict(draw.program.switches).get("INDIRECT", 0) for draw in self.draws)

    @property
    def has_bodies(self) -> bool:
        """Whether there is glass that light is refracted into."""
        return self.is_everything or any(draw.transmits == 2 for draw in self.draws)

    @property
    def has_walls(self) -> bool:
        """Whether there is glass without thickness."""
        return self.is_everything or any(draw.transmits == 1 for draw in self.draws)

    def to_json(self) -> dict[str, object]:
        passes = ["shadows"] * bool(self.shadow_layer_count) + ["visibility"] * self.has_visibility
        passes += ["reflections"] * self.has_traced
        passes += ["surfaces"] * bool(self.draws)
        passes += ["bodies of glass"] if self.has_bodies else []
        passes += ["background"] if self.background else []
        passes += ["walls of glass"] if self.has_walls else []
        passes += ["blend"] if self.has_blended else []
        return {
            "passes": [*passes, "display"],
            "programs": [{"fragment": p.fragment, "on": {k: v for k, v in p.switches if v}} for p in self.programs],
            "draws": len(self.draws),
            "maps": sorted({f"{draw.material}:{name}" for draw in self.draws for name in draw.maps}),
            "lights": len(self.lights),
            "shadow_layers": self.shadow_layer_count,
            "used": list(self.used),
            "left_out": list(self.left_out),
            "saved": dict(self.saved),
        }
