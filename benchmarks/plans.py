"""What leaving out saves: each model by the plan of what it needs and by the one that leaves nothing out, in turn.

    python -m benchmarks.plans [MODEL ...] [--results DIR]

First frames have programs, bakes, textures and buffers to make, with no cache on disk; shader lines are those that the
switches leave, of all fragment programs. Processor seconds are told beside the wall's: other work on the machine counts
less in them.
"""

from __future__ import annotations

import argparse
import os
from pathlib import Path

import numpy as np

from viewer.errors import InputError
from viewer.gpu.context import Context, open_context
from viewer.plan import Plan, plan_scene
from viewer.scene.environment_files import load_environment
from viewer.scene.load import load_scene
from viewer.scene.scene import Scene
from viewer.settings import Settings

from . import machine, shot, tracing
from .drawing import Viewer, compile_anew
from .shader_code import lines_left

PLANS = ("needed", "everything")
COLUMNS = {"model": "model", "programs": "programs", "of all": "all_programs", "shader lines": "lines:,",
           "of all ": "all_lines:,", "MB": "mb:.1f", "of all  ": "all_mb:.1f", "first frame, CPU s": "first_cpu:.2f",
           "of all   ": "all_first_cpu:.2f", "later frame, CPU ms": "later_cpu:.1f", "of all    ": "all_later_cpu:.1f",
           "levels apart": "apart"}


def main() -> None:
    options = _parse()
    compile_anew()
    environment = load_environment(options.env)
    rows: list[dict[str, object]] = []
    with open_context(options.backend) as context:
        _compare(context, load_scene(shot.REPOSITORY / "assets/demo.glb").relit(environment=environment), options)
        for path in options.models:
            try:
                scene = load_scene(path).relit(environment=environment)
            except InputError as error:
                print(f"{error}: left out")
                continue
            rows.append({"model": Path(path).stem} | _compare(context, scene, options))
            print(rows[-1], flush=True)
        facts = machine.here() | {"renderer": context.renderer, "load average": os.getloadavg()[0],
                                  "size": f"{options.size}x{options.size}", "environment": Path(options.env).name}
    text = ["# Needed against everything", "", *tracing.table(rows, COLUMNS), "", *_summary(rows)]
    tracing.keep("plans", facts, rows, text, options.results)


def _compare(context: Context, scene: Scene, options: argparse.Namespace) -> dict[str, object]:
    size = options.size, options.size
    viewers = {plan: Viewer(context, scene, Settings(plan=plan), size) for plan in PLANS}
    for number in range(1, options.frames + 1):
        for viewer in viewers.values():
            viewer.draw(number)
    row: dict[str, object] = {}
    for plan, prefix in zip(PLANS, ("", "all_")):
        found = viewers[plan].frames.to_json() | {"lines": _lines(scene, plan)}
        row |= {prefix + name: value for name, value in found.items()}
        viewers[plan].release()
    needed, everything = (viewers[plan].picture.astype(int) for plan in PLANS)
    return row | {"apart": int(np.abs(needed - everything).max())}


def _lines(scene: Scene, plan: str) -> int:
    found: Plan = plan_scene(scene, Settings(plan=plan), scene.lights, samples=4, half_target=True, orthographic=False)
    return sum(len(lines_left(program.fragment, dict(program.switches))) for program in found.programs)


def _summary(rows: list[dict[str, object]]) -> list[str]:
    """Ratios of the whole to what is needed, the median model and the one that gains least."""
    lines = []
    names = {"lines": "shader lines", "mb": "MB", "first_cpu": "first frame", "later_cpu": "later frame"}
    for key, name in names.items():
        ratios = sorted(row[f"all_{key}"] / row[key] for row in rows if row[key])
        if ratios:
            lines.append(f"- {name}: everything takes {np.median(ratios):.2f} times what is needed (median of "
                         f"{len(ratios)} models; {ratios[0]:.2f} to {ratios[-1]:.2f})")
    return lines


def _parse() -> argparse.Namespace:
    corpus = shot.REPOSITORY.parent / "shared" / "corpus" / "models"
    models = sorted(str(path) for path in corpus.glob("*/*.gl*") if path.is_file())
    parser = argparse.ArgumentParser(prog="python -m benchmarks.plans", description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("models", nargs="*", default=models or [str(shot.REPOSITORY / "assets/demo.glb")])
    parser.add_argument("--env", default=shot.default_environment())
    parser.add_argument("--size", type=int, default=256)
    parser.add_argument("--frames", type=int, default=5)
    parser.add_argument("--backend", default="auto")
    parser.add_argument("--results", type=Path, default=shot.REPOSITORY / "benchmarks/results")
    return parser.parse_args()


if __name__ == "__main__":
    main()
