"""A scene with balls that throw light of a lamp on a floor, and its guide to caustics on the GPU and in float64."""

from __future__ import annotations

import numpy as np
from harness import evaluate
from test_light_sampling import place, scene_of

from viewer.bake.dfg import dfg_albedos
from viewer.gpu.float_texture import float_texture
from viewer.plan.bsdf_switches import bsdf_switches
from viewer.scene.material import Material
from viewer.scene.mesh import Mesh
from viewer.scene.scene import Instance, Scene
from viewer.settings import Settings
from viewer.trace.layout import GUIDE_CELLS, GUIDE_STEPS
from viewer.trace.scene import caustic_guide
from viewer.trace.scene.caustic_guide import CausticGuide, place_of, square_of
from viewer.trace.scene.geometry import trace_geometry
from viewer.trace.scene.lights import SceneLights
from viewer.trace.scene.scene_data import SceneData
from viewer.trace.tracer import UNIT_DFG

METAL = Material("metal", metallic=1.0, perceptual_roughness=0.1)
LAMP = Material("lamp", emissive=(60.0, 60.0, 60.0))
ABOVE = place(-0.5, 1.0, 0.0, (0.2, 1.0, 0.2), np.pi)  # shines down
CENTER, RADIUS = np.array([0.5, -0.5, 0.0]), 0.4
FUNCTIONS = """#include "trace/scene_buffer.glsl"
#include "trace/caustic_guide.glsl"
"""


def with_ball(material: Material, *placed: tuple[Material, np.ndarray]) -> Scene:
    """Quads, and a ball of `material`."""
    scene, rings, segments = scene_of(*placed), 12, 24
    theta, phi = np.meshgrid(np.linspace(0, np.pi, rings + 1), np.linspace(0, 2 * np.pi, segments + 1), indexing="ij")
    points = np.stack([np.sin(theta) * np.cos(phi), np.cos(theta), -np.sin(theta) * np.sin(phi)], -1).reshape(-1, 3)
    at = (np.arange(rings)[:, None] * (segments + 1) + np.arange(segments)).ravel()
    below = at + segments + 1
    corners = np.stack([at, below, at + 1, at + 1, below, below + 1], -1).ravel().astype(np.uint32)
    ball = Mesh("ball", points.astype(np.float32), len(placed), indices=corners, normals=points.astype(np.float32))
    matrix = np.diag([RADIUS, RADIUS, RADIUS, 1.0])
    matrix[:3, 3] = CENTER
    return Scene("ball", (*scene.meshes, ball), (*scene.materials, material),
                 (*scene.instances, Instance(len(placed), matrix)))


class Guided:
    """The guide of a scene, on the GPU and in float64."""

    def __init__(self, context, folder, scene: Scene) -> None:
        self.context, self.folder, self.scene = context, folder, scene
        geometry = trace_geometry(scene)
        self.data = SceneData(context, scene, geometry)
        lights = SceneLights(context, scene, geometry, self.data.buffer, Settings())
        self.guide = CausticGuide(scene, geometry, self.data.buffer, lights)
        self.data.upload()
        self.tables = self.guide.tables
        self.switches = {**self.data.switches, **lights.switches, **self.guide.switches, **bsdf_switches(Settings())}
        self.dfg = float_texture(context.gl, dfg_albedos("ggx", "smith"))

    def run(self, body: str, rows: np.ndarray, outputs: int = 1, functions: str = FUNCTIONS) -> np.ndarray:
        def bind(program) -> None:
            self.data.bind(program)
            if "u_dfg" in program:
                self.dfg.use(UNIT_DFG)
                program["u_dfg"] = UNIT_DFG
            for name, value in self.guide.uniforms.items():
                program[name] = value
        (self.folder / "guide.glsl").write_text(functions)
        return evaluate(self.context, self.folder, "guide.glsl", body, rows.astype(np.float32), outputs, self.switches,
                        bind)

    def to_tracer(self, p: np.ndarray) -> np.ndarray:
        return (p - self.scene.center) / self.scene.radius

    def density(self, p: np.ndarray, direction: np.ndarray, k: int = 0) -> np.ndarray:
        """By solid angle, from the point (3,) in tracer space to the caster k"""
        caster = self.tables[k].caster
        away = np.tile(p - caster.center, (len(direction), 1))
        distance = np.linalg.norm(away[0])
        away /= distance
        ratio = caster.radius / distance
        square = square_of(np.full(len(away), ratio), away, direction)
        column, row = np.minimum(square * GUIDE_CELLS, GUIDE_CELLS - 1).astype(int).T
        inside = ((square > 0) & (square < 1)).all(axis=1)
        weights = self.tables[k].weights[place_of(away)[0]]
        spread = 1 - np.sqrt(1 - ratio**2)
        # Lambert's azimuthal map has the area of the directions, times a factor; the square's edges are 2 * spread away
        return inside * cells_of(weights)[row * GUIDE_CELLS + column] * GUIDE_CELLS**2 / (8 * spread)


def cells_of(weights: np.ndarray) -> np.ndarray:
    """The probabilities of cells with these weights; those that the disk does not touch have none."""
    edges = np.linspace(-1, 1, GUIDE_CELLS + 1)
    nearest = np.where(edges[:-1] >= 0, edges[:-1], -edges[1:]).clip(0)
    on_disk = (nearest[:, None] ** 2 + nearest**2 < 1).ravel()
    weights = weights * on_disk
    exact = (1 - caustic_guide.FLOOR) * weights / weights.sum() + caustic_guide.FLOOR * on_disk / on_disk.sum()
    rounded = caustic_guide.cell_steps(weights[None])[0] / GUIDE_STEPS
    assert rounded.sum() == 1 and not rounded[~on_disk].any() and np.abs(rounded - exact).max() < 1.01 / GUIDE_STEPS
    return rounded


