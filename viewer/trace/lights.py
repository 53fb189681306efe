"""What shines on a scene, as shaders/trace/lights.glsl chooses among it: environment, punctual lights, emitters."""

from __future__ import annotations

import math

import moderngl
import numpy as np

from ..gpu.context import Context
from ..raster.lights import spot_cone
from ..raster.programs import set_uniform
from ..scene.equirect import sphere_integral
from ..scene.light import Light
from ..scene.scene import Scene
from ..settings import Settings
from .alias import alias_table
from .emitters import LUMINANCE, find_emitters
from .environment import EnvironmentTable
from .geometry import TraceGeometry
from .words import WordsBuilder

LEAST_SHARE = 0.25
"""Of the light samples that both the environment and the other lights get, where there are both.

Power tells nothing of who is near, or shadowed: what is all of the light at some point may be little of it in all."""


class SceneLights:
    """Adds its sections to `words` and makes the environment's textures.

    `switches` are the defines of shaders/trace/lights.glsl; `left_out` says in words what is no light although it is
    in the scene. Raises InputError for an environment or an emissive texture that cannot be decoded.
    """

    def __init__(self, context: Context, scene: Scene, geometry: TraceGeometry, words: WordsBuilder,
                 settings: Settings) -> None:
        self.left_out: list[str] = []
        environment = scene.environment
        self._environment: EnvironmentTable | None = None
        environment_power = 0.0
        if environment is not None:
            radiance = environment.radiance if environment.intensity > 0 else np.zeros((1, 1, 3), np.float32)
            environment_power = environment.intensity * float(sphere_integral(radiance) @ LUMINANCE) / 4
            if environment_power > 0:
                self._environment = EnvironmentTable(context.gl, environment, radiance)
            else:
                self.left_out.append("the environment: it is black")

        punctual = [(light, power(light, scene)) for light in scene.lights]
        lit = [(light, watts) for light, watts in punctual if watts > 0]
        if len(lit) < len(punctual):
            self.left_out.append(f"{len(punctual) - len(lit)} of {len(punctual)} lights: nothing is lit by them")
        emitters, emitted = find_emitters(scene, geometry)
        if settings.lobes != "all" or not emitted.any():
            emitters, emitted = emitters[:0], emitted[:0]
        radius = settings.light_radius / scene.radius

        powers = np.concatenate([[watts for _, watts in lit], emitted])
        total = environment_power + powers.sum()
        share = environment_power / total if total > 0 else 0.0
        if 0 < share < 1:
            share = min(max(share, LEAST_SHARE), 1 - LEAST_SHARE)
        self._uniforms: dict[str, object] = {"u_environment_share": share, "u_light_radius": radius}
        if len(powers):
            self._uniforms |= {"u_punctual_count": len(lit), "u_light_grid": _grid(len(powers))}
            words.add("lights", light_table(powers, 1 - share))
        if lit:
            words.add("punctual", punctual_words([light for light, _ in lit], scene))
        if len(emitters):
            words.add("emitters", emitters)
        self.switches = {
            "HAS_ENVIRONMENT": int(self._environment is not None),
            "ENVIRONMENT_ROTATED": int(self._environment is not None and environment.rotation != 0),
            "HAS_PUNCTUAL": int(bool(lit)),
            "HAS_EMITTERS": int(len(emitters) > 0),
            "LIGHT_RADIUS": int(radius > 0 and any(light.kind != "directional" for light, _ in lit)),
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


def power(light: Light, scene: Scene) -> float:
    """What reaches the scene's bounding sphere, about, by luminance and in tracer units; 0 only if nothing does."""
    luminance = float(LUMINANCE @ light.color) * light.intensity
    if light.kind == "directional":
        return min(math.pi * luminance, 1e300)
    distance = float(np.linalg.norm(light.position - scene.center)) / scene.radius
    if light.range is not None and light.range <= (distance - 1) * scene.radius:
        return 0.0
    cone = 4 * math.pi
    if light.kind == "spot":
        cone = 2 * math.pi * (1 - math.cos((light.inner_cone + light.outer_cone) / 2))
    # From a distance d the sphere takes up pi / d^2; to a light within it all around is scene.
    angle = min(max(cone, 1e-6), 4 * math.pi / max(1.0, 4 * distance**2))
    return min(luminance / scene.radius / scene.radius * angle, 1e300)


def punctual_words(lights: list[Light], scene: Scene) -> np.ndarray:
    """(3 N, 4) float32: see shaders/trace/punctual.glsl.

    An intensity in candela meets distances in tracer units: I / d^2 stays the same when both are divided by unit^2.
    """
    words = np.zeros((len(lights), 3, 4))
    unit = scene.radius
    for row, light in zip(words, lights):
        if light.kind == "directional":
            row[0] = *np.negative(light.direction), -1.0
            row[1, :3] = np.multiply(light.color, light.intensity)
            continue
        row[0, :3] = (light.position - scene.center) / unit
        row[0, 3] = (unit / light.range) ** 2 if light.range else 0.0
        row[1, :3] = np.multiply(light.color, light.intensity / unit / unit)
        row[2, :3] = light.direction
        row[1, 3], row[2, 3] = spot_cone(light) if light.kind == "spot" else (0.0, 1.0)
    return np.clip(words, -3e38, 3e38).astype(np.float32).reshape(-1, 4)


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
