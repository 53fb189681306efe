"""The lights of a scene and the tables by which shaders/trace/lights.glsl samples them.

There are three kinds: the environment, punctual lights, and emissive triangles. Few lights are chosen by their power;
of more than `MOST_BY_POWER` that have a place, one is chosen by a tree (light_tree.py).
"""

from __future__ import annotations

import math

import moderngl
import numpy as np

from ...gpu.context import Context
from ...gpu.programs import set_uniform
from ...scene.color import LUMINANCE
from ...scene.environment import Environment
from ...scene.equirect import sphere_integral
from ...scene.scene import Scene
from ...settings import Settings
from .alias import alias_table
from .emitters import find_emitters
from .encode import transmits
from .environment import EnvironmentTable
from .geometry import TraceGeometry
from .inside import solids_around
from .light_bounds import light_bounds
from .light_tree import build_light_tree
from .punctual import LightColumns
from .scene_buffer import SceneBufferBuilder

LEAST_SHARE = 0.25
"""Least share of the light samples that the environment gets, and that the other lights get, if the scene has both.

The share follows the power. But power says nothing about distance and shadows: a light with little power may be the
only one that reaches some point."""

MOST_BY_POWER = 8
"""Point and spot lights and emissive triangles that are chosen by their power alone. The tree chooses among more."""


def _candidates(scene: Scene, geometry: TraceGeometry) -> dict[str, int]:
    """Of how many light samples one is chosen, at what the camera sees and at later hits. Two are worth their time
    (benchmarks/results/trace_variance.md): under an environment at first, in rooms with emissive triangles, where later
    hits bring more of the noise, everywhere. With glass most noise is of light that no light sample finds, and of many
    triangles a sample costs more (light_tree.py)."""
    has_glass = transmits(geometry)
    is_room = scene.environment is None and 0 < geometry.emitters <= MOST_BY_POWER
    return {"FIRST_CANDIDATES": 1 + (not has_glass and (scene.environment is not None or is_room)),
            "LATER_CANDIDATES": 1 + (not has_glass and is_room)}


class SceneLights:
    """Adds its sections to `buffer` and makes the environment's textures.

    `switches` are the defines of shaders/trace/lights.glsl. `left_out` has lines for the user about lights of the scene
    that have no effect. Without a context these two are all that is made. Raises InputError for an environment or an
    emissive texture that cannot be decoded.
    """

    def __init__(self, context: Context | None, scene: Scene, geometry: TraceGeometry, buffer: SceneBufferBuilder,
                 settings: Settings, previous: SceneLights | None = None) -> None:
        """`previous` is released. If its environment has the same map, that is taken over."""
        self.left_out: list[str] = []
        environment = scene.environment
        self._environment: EnvironmentTable | None = None
        self._unit_power = 0.0  # of the environment at intensity 1
        if environment is not None and environment.intensity > 0:
            if previous is not None and previous._environment is not None and previous._environment.holds(environment):
                self._environment, previous._environment = previous._environment, None
                self._environment.environment, self._unit_power = environment, previous._unit_power
            else:
                radiance = environment.radiance
                self._unit_power = float(sphere_integral(radiance) @ LUMINANCE) / 4
                if self._unit_power > 0 and context is not None:
                    self._environment = EnvironmentTable(context, environment, radiance)
        if self._environment is not None:
            self._environment.blur_background(settings.background_blur)
        if previous is not None:
            previous.release()
        if self._environment is None and context is not None and settings.plan == "everything":
            grey = np.ones((2, 4, 3), np.float32)
            self._environment = EnvironmentTable(context, Environment("none", grey, intensity=0.0), grey)
        environment_power = self._unit_power * environment.intensity if environment is not None else 0.0
        if environment is not None and not environment_power > 0:
            self.left_out.append("the environment: it is black")

        columns = LightColumns.of(scene.lights, scene)
        light_powers = columns.powers
        numbers = np.flatnonzero(light_powers > 0)
        if len(numbers) < len(columns):
            self.left_out.append(f"{len(columns) - len(numbers)} of {len(columns)} lights: nothing is lit by them")
        emitters, emitted = find_emitters(scene, geometry)
        if settings.lobes != "all" or not emitted.any():
            emitters, emitted = emitters[:0], emitted[:0]
        self.emitters = emitters.copy(), emitted
        """The records and powers of the emissive triangles (emitters.py)."""
        radius = settings.light_radius / scene.radius

        is_lamp = ~columns.is_far[numbers]
        has_tree = np.count_nonzero(is_lamp) + np.count_nonzero(emitted) > MOST_BY_POWER
        if has_tree:  # directional lights come first
            numbers = np.concatenate([numbers[~is_lamp], numbers[is_lamp]])
        columns, light_powers = columns[numbers], light_powers[numbers]
        powers = np.concatenate([light_powers, emitted])
        has_environment = environment_power > 0
        share = float(has_environment)
        if has_environment and len(powers):
            share = _share(environment_power, powers.sum())
        if settings.plan == "everything" and not len(powers):
            share = 1.0  # of the black environment
        self._uniforms: dict[str, object] = {"u_environment_share": share, "u_light_radius": radius}
        if geometry.scatters:
            places = columns.position[~columns.is_far]
            self._uniforms |= {
                "u_finite_share": 1 - share, "u_emitter_share": float(emitted.sum() / max(powers.sum(), 1e-300)),
                "u_has_light_within": any(instance.medium not in geometry.open_media for place in places
                                          for instance in solids_around(geometry, place))}
        self._uniforms["u_punctual_count"] = len(columns)
        if has_tree:
            self._add_tree(geometry, buffer, columns, light_powers, emitters, emitted, 1 - share, radius)
        elif len(powers):
            self._uniforms["u_light_grid"] = _grid(len(powers))
            buffer.add("lights", light_table(powers, 1 - share))
        if len(columns):
            buffer.add("punctual", columns.texels)
        if len(emitters):
            buffer.add("emitters", emitters)
        self.lit = [scene.lights[number] for number in numbers]
        """The lights without size that reach the scene, in the order of their records."""
        self.switches = {
            "HAS_ENVIRONMENT": int(has_environment),
            "ENVIRONMENT_ROTATED": int(has_environment and environment is not None and environment.rotation != 0),
            "HAS_PUNCTUAL": int(len(columns) > 0),
            "HAS_EMITTERS": int(len(emitters) > 0),
            "HAS_LIGHT_TREE": int(has_tree),
            "HAS_AIRLIGHT": int(geometry.scatters and len(columns) > 0),
            "LIGHT_RADIUS": int(radius > 0 and not columns.is_far.all()),
            **_candidates(scene, geometry),
        }

    def _add_tree(self, geometry: TraceGeometry, buffer: SceneBufferBuilder, lit: LightColumns, powers: np.ndarray,
                  emitters: np.ndarray, emitted: np.ndarray, share: float, radius: float) -> None:
        """Add the tree, and the table of directional lights, which are the first ones of `lit`; tell `emitters` their
        ways. Both together have the probability `share`. `powers` are those of `lit`."""
        count, is_lit = int(lit.is_far.sum()), emitted > 0
        far, lamps = powers[:count].sum(), powers[count:].sum()
        far_share = _share(far, lamps + emitted.sum())
        tree = build_light_tree(light_bounds(lit[~lit.is_far], radius, geometry, emitters[is_lit], emitted[is_lit]))
        # Of a light in the tree: its number among lamps and emitters
        numbers = np.concatenate([np.arange(count, len(lit)), len(lit) + np.flatnonzero(is_lit)])
        emitters[is_lit, 2], emitters[is_lit, 3] = tree.trails[len(lit) - count:], 1
        buffer.add("light_tree", tree.texels(numbers))
        if count:
            buffer.add("lights", light_table(powers[:count], share * far_share))
        self._uniforms |= {"u_light_grid": _grid(max(count, 1)), "u_far_share": far_share,
                           "u_tree_share": share * (1 - far_share)}
        if geometry.scatters:
            self._uniforms |= {"u_air_far_share": _share(far, lamps), "u_finite_share": share * far_share}

    def is_background_smooth(self, pixel_angle: float) -> bool:
        """Whether camera rays see the environment by B-splines, in a picture whose pixels have that angle."""
        return self._environment is not None and self._environment.is_background_smooth(pixel_angle)

    @property
    def background_rows(self) -> int:
        """Rows of the map that camera rays see; 0 if there is none."""
        return 0 if self._environment is None else self._environment.background_rows

    def use_textures(self) -> None:
        """Bind the textures to their units."""
        if self._environment is not None:
            self._environment.use_textures()

    def set_uniforms(self, program: moderngl.Program) -> None:
        """Set all uniforms except the first texels of the sections."""
        for name, value in self._uniforms.items():
            set_uniform(program, name, value)
        if self._environment is not None:
            self._environment.set_uniforms(program)

    def release(self) -> None:
        if self._environment is not None:
            self._environment.release()


def _share(power: float, others: float) -> float:
    """The share of samples for lights of this power beside those of the others."""
    if not (power > 0 and others > 0):
        return float(power > 0)
    return min(max(power / (power + others), LEAST_SHARE), 1 - LEAST_SHARE)


def light_table(powers: np.ndarray, share: float) -> np.ndarray:
    """The alias table of shaders/trace/lights.glsl, (rows * columns, 4) uint32. The probabilities sum to `share`."""
    columns, rows = _grid(len(powers))
    padded = np.zeros(rows * columns)
    padded[: len(powers)] = powers / powers.max()
    threshold, alias = alias_table(padded)
    probability = (share * padded / padded.sum()).astype(np.float32)
    texels = np.empty((len(padded), 4), np.uint32)
    texels[:, 0], texels[:, 1] = threshold.astype(np.float32).view(np.uint32), alias
    texels[:, 2], texels[:, 3] = probability.view(np.uint32), probability[alias].view(np.uint32)
    return texels


def _grid(count: int) -> tuple[int, int]:
    """Columns and rows, of about equal number, for `count` entries."""
    rows = math.isqrt(count - 1) + 1
    return -(-count // rows), rows
