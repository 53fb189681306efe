"""What a moving model costs beside one that stands still: python -m benchmarks.poses [MODEL...]. In each round, as many
poses of an animation are drawn as frames of the model at rest, and the ratio is taken within the round.
"""

from __future__ import annotations

import argparse
import time
from dataclasses import replace
from pathlib import Path

import numpy as np

import viewer
from viewer.gpu.context import open_context
from viewer.measure.check.scenes import scene
from viewer.raster.renderer import Renderer
from viewer.scene.animation import Animation, Target, Track
from viewer.scene.deform import Deformation, influences
from viewer.scene.environment_files import load_environment
from viewer.scene.material import Material
from viewer.scene.mesh import Mesh
from viewer.scene.rig import Deformed, Nodes, Rig, Skin
from viewer.scene.scene import Scene
from viewer.settings import Settings
from viewer.trace.tracer import Tracer

from . import tracing
from .shot import REPOSITORY, default_environment

SIZE, FRAMES, ROUNDS = 256, 60, 9
COLUMNS = {"model": "model:", "vertices": "vertices", "joints": "joints", "pose, ms": "pose_ms:.2f",
           "still frame, ms": "still_ms:.1f", "moving frame, ms": "moving_ms:.1f", "moving / still": "ratio:.2f",
           "p10": "ratio_p10:.2f", "p90": "ratio_p90:.2f"}


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.poses", description=__doc__)
    parser.add_argument("models", nargs="*", help="animated models, beside a tube of 3,300 vertices and 19 joints")
    parser.add_argument("--results", type=Path, default=REPOSITORY / "benchmarks/results")
    options = parser.parse_args()
    environment = load_environment(default_environment())
    scenes = [tube(), *(viewer.load(path, environment=None) for path in options.models)]
    with open_context() as context:
        rows = [_measure(Renderer(context), replace(scene, environment=environment)) for scene in scenes]
        conditions = tracing.conditions(Tracer(context))
    text = [f"# Poses beside frames at rest, {SIZE} x {SIZE}", "", *tracing.table(rows, COLUMNS), "",
            f"Medians of {ROUNDS} rounds of {FRAMES} frames each, in turn, pixels in memory. A pose is `Scene.at`; it",
            "is in the time of a moving frame."]
    tracing.keep("poses", conditions, rows, text, options.results)


def _measure(renderer: Renderer, still: Scene) -> dict[str, object]:
    camera, settings, times = still.framing_camera(1.0), Settings(), np.arange(FRAMES) / FRAMES
    times *= still.animations[0].duration

    def frames(moves: bool) -> tuple[float, float]:
        """Seconds of all frames, and of working out the poses."""
        begin, posing = time.perf_counter(), 0.0
        for moment in times:
            start = time.perf_counter()
            shown = still.at(moment) if moves else still
            posing += time.perf_counter() - start
            renderer.display(shown, camera, settings, (SIZE, SIZE))
        return time.perf_counter() - begin, posing

    frames(False), frames(True)
    rounds = np.array([(frames(False)[0], *frames(True)) for _ in range(ROUNDS)])  # seconds: still, moving, posing
    ratios = rounds[:, 1] / rounds[:, 0]
    still_ms, moving_ms, pose_ms = np.median(rounds, axis=0) / FRAMES * 1e3
    skins = [deformed.skin for deformed in still.rig.deformed.values() if deformed.skin] if still.rig else []
    renderer.release()
    return {"model": still.name, "vertices": sum(len(mesh.positions) for mesh in still.meshes),
            "joints": max((len(skin.joints) for skin in skins), default=0), "pose_ms": pose_ms, "still_ms": still_ms,
            "moving_ms": moving_ms, "ratio": float(np.median(ratios)), "ratio_p10": float(np.percentile(ratios, 10)),
            "ratio_p90": float(np.percentile(ratios, 90))}


def tube(rows: int = 66, columns: int = 50, joints: int = 19) -> Scene:
    """A tube that a chain of joints bends, of about the size of Khronos' CesiumMan: 3,300 vertices, 19 joints."""
    height, angle = np.meshgrid(np.linspace(0, 1, rows), np.linspace(0, 2 * np.pi, columns), indexing="ij")
    outward = np.stack([np.cos(angle), 0 * angle, -np.sin(angle)], axis=-1).reshape(-1, 3)
    positions = 0.15 * outward + [0, 1, 0] * height.reshape(-1, 1)
    first = (np.arange(rows - 1)[:, None] * columns + np.arange(columns - 1)).ravel()
    corners = np.stack([first, first + 1, first + columns, first + columns, first + 1, first + columns + 1], axis=1)
    rest = Mesh("tube", positions, 0, indices=corners.ravel(), normals=outward)
    nearest = height.reshape(-1, 1) * (joints - 1) + np.array([-1, 0, 1, 2])
    numbers = np.clip(np.floor(nearest), 0, joints - 1).astype(int)
    weights = np.maximum(2 - np.abs(height.reshape(-1, 1) * (joints - 1) - numbers), 0)
    step = 1 / (joints - 1)
    bind = np.tile(np.eye(4), (joints, 1, 1))
    bind[:, 1, 3] = -step * np.arange(joints)
    places = np.array([[0, step * (k > 0), 0] for k in range(joints)])
    nodes = Nodes(np.arange(-1, joints - 1), np.arange(joints), places, np.tile([0.0, 0.0, 0.0, 1.0], (joints, 1)),
                  np.ones((joints, 3)), {}, np.ones(joints, bool))
    bend = np.array([[0, 0, np.sin(x), np.cos(x)] for x in (0.0, 0.03, 0.0, -0.03, 0.0)])
    tracks = tuple(Track(Target("node", k, "rotation"), np.arange(5) / 4, bend) for k in range(joints))
    deformed = Deformed(rest, Deformation((), *influences(numbers, weights)), 0, (), Skin(np.arange(joints), bind))
    rig = Rig(nodes, np.array([0]), deformed={0: deformed}, is_skinned=np.array([True]))
    still = scene([rest], [Material(base_color=(0.8, 0.4, 0.2, 1.0), metallic=0.0, perceptual_roughness=0.5)])
    return replace(still, name="tube", animations=(Animation("sway", tracks),), rig=rig)


if __name__ == "__main__":
    main()
