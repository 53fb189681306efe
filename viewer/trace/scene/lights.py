"""What shines on a scene, as shaders/trace/lights.glsl chooses among it: environment, punctual lights, emitters."""

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
from .environment import EnvironmentTable
from .geometry import TraceGeometry
from .punctual import light_powers, punctual_words
from .scene_buffer import WordsBuilder

LEAST_SHARE = 0.25
"""Of the light samples that both the environment and the other lights get, where there are both.

Power tells nothing of who is near, or shadowed: what is all of the light at some point may be little of it in all."""


class SceneLights:
    """Adds its sections to `words` and makes the environment's textures.

    `switches` are the defines of shaders/trace/lights.glsl; `left_out` says in words what is no light although it is
    in the scene; without a context that is all it tells. Raises InputError for an environment or an emissive texture
    that cannot be decoded.
    """

    def __init__(self, context: Context | None, scene: Scene, geometry: TraceGeometry, words: WordsBuilder,
                 settings: Settings, previous: SceneLights | None = None) -> None:
        """`previous` is let go of: its environment is taken over if it is the same map, turned and scaled at most."""
        self.left_out: list[str] = []
        environment = scene.environment
        self._environment: EnvironmentTable | None = None
        self._unit_power = 0.0  # of the environment, were its intensity 1
        if environment is not None and environment.intensity > 0:
            if previous is not None and previous._environment is not None and previous._environment.holds(environment):
                self._environment, previous._environment = previous._environment, None
                self._environment.environment, self._unit_power = environment, previous._unit_power
            else:
                radiance = environment.radiance
                self._unit_power = float(sphere_integral(radiance) @ LUMINANCE) / 4
                if self._unit_power > 0 and context is not None:
                    self._environment = EnvironmentTable(context.gl, environment, radiance)
        if previous is not None:
            previous.release()
        if self._environment is None and context is not None and settings.plan == "everything":
            grey = np.ones((2, 4, 3), np.float32)
            self._environment = EnvironmentTable(context.gl, Environment("none", grey, intensity=0.0), grey)
        environment_power = self._unit_power * environment.intensity if environment is not None else 0.0
        if environment is not None and not environment_power > 0:
            self.left_out.append("the environment: it is black")

        given = light_powers(scene.lights, scene) if scene.lights else np.zeros(0)
        lit = [light for light, power in zip(scene.lights, given) if power > 0]
        if len(lit) < len(given):
            self.left_out.append(f"{len(given) - len(lit)} of {len(given)} lights: nothing is lit by them")
        emitters, emitted = find_emitters(scene, geometry)
        if settings.lobes != "all" or not emitted.any():
            emitters, emitted = emitters[:0], emitted[:0]
        radius = settings.light_radius / scene.radius

        powers = np.concatenate([given[given > 0], emitted])
        has_environment = environment_power > 0
        share = float(has_environment)
        if has_environment and len(powers):
            share = environment_power / (environment_power + powers.sum())
            share = min(max(share, LEAST_SHARE), 1 - LEAST_SHARE)
        if settings.plan == "everything" and not len(powers):
            share = 1.0  # of the black environment
        self._uniforms: dict[str, object] = {"u_environment_share": share, "u_light_radius": radius}
        if len(powers):
            self._uniforms |= {"u_punctual_count": len(lit), "u_light_grid": _grid(len(powers))}
            words.add("lights", light_table(powers, 1 - share))
        if lit:
            words.add("punctual", punctual_words(lit, scene))
        if len(emitters):
            words.add("emitters", emitters)
        self.switches = {
            "HAS_ENVIRONMENT": int(has_environment),
            "ENVIRONMENT_ROTATED": int(has_environment and environment is not None and environment.rotation != 0),
            "HAS_PUNCTUAL": int(bool(lit)),
            "HAS_EMITTERS": int(len(emitters) > 0),
            "LIGHT_RADIUS": int(radius > 0 and any(light.kind != "directional" for light in lit)),
        }

    def bind(self, program: moderngl.Program) -> None:
        """Bind the textures and set the uniforms, but for the places of the sections."""
        for name, value in self._uniforms.items():
            set_uniform(program, name, value)
        if self._environment is not None:
            self._environment.bind(program)

    def release(self) -> None:
        if self._environment is not None:
            self._environment.release()


def light_table(powers: np.ndarray, share: float) -> np.ndarray:
    """(rows * columns, 4) uint32: see shaders/trace/lights.glsl. The probabilities add up to `share`."""
    columns, rows = _grid(len(powers))
    padded = np.zeros(rows * columns)
    padded[: len(powers)] = powers / powers.max()
    threshold, alias = alias_table(padded)
    probability = (share * padded / padded.sum()).astype(np.float32)
    words = np.empty((len(padded), 4), np.uint32)
    words[:, 0], words[:, 1] = threshold.astype(np.float32).view(np.uint32), alias
    words[:, 2], words[:, 3] = probability.view(np.uint32), probability[alias].view(np.uint32)
    return words


def _grid(count: int) -> tuple[int, int]:
    """Columns and rows, about as many of both, that hold `count`."""
    rows = math.isqrt(count - 1) + 1
    return -(-count // rows), rows
