"""How near the raster comes to the truth in ten times the time of plain image-based light, model by model.

    python -m benchmarks.reach [MODEL ...] [--env NAME ...] [--references DIR] [--results DIR]

Every raster method of the report's ladder draws the model; its error is relMSE over the pixels that the model covers
wholly, against a path-traced reference, whose noise floor is taken off. Of those whose steady frame takes at most
`--times` as long as plain's the nearest to the truth is told, timed again in turn with plain.
"""

from __future__ import annotations

import argparse
import os
from pathlib import Path

from viewer.errors import InputError
from viewer.gpu.context import Context, open_context
from viewer.measure.report.ladder import PLAIN, Method, ladder
from viewer.measure.report.store import Record
from viewer.measure.report.time_limit import reason_against
from viewer.measure.report.timing import frame_effort
from viewer.scene.camera import Camera
from viewer.scene.environment_files import load_environment
from viewer.scene.load import load_scene
from viewer.scene.scene import Scene
from viewer.settings import Settings

from . import corpus, machine, shot, tracing
from .reach_frames import Frames
from .reach_table import by_family, summary
from .reach_truth import Truth

MODELS = ("FlightHelmet", "DamagedHelmet", "SheenCloth", "Fox", "CesiumMilkTruck", "Duck", "Suzanne", "ToyCar",
          "MetalRoughSpheresNoTextures", "BoxTextured", "Box", "GlassVaseFlowers", "AlienCake-tile", "Mountains",
          "GlamVelvetSofa", "ClearcoatWicker", "NormalTangentTest", "RiggedFigure", "SimpleInstancing", "set_and_get",
          "sphere-lights", "blender-transmission", "LightsPunctualLamp", "alien-scolitex")
ENVIRONMENTS = ("studio_small_05_1k", "noon_grass_1k")
GAIN = 3.0
"""At most a third of plain's error is asked for."""
_EDGES = ("none", "msaa-4", "ssaa-4", "ssaa-9", "ssaa-16")
COLUMNS = {"model": "model", "environment": "environment", "plain": "plain:.4f", "ms": "plain_ms:.1f",
           "nearest in time": "best", "relMSE": "error:.4f", "of plain's time": "times:.1f", "gain": "gain:.1f",
           "trimmed gain": "trimmed_gain:.1f", "noise floor": "floor:.4f", "at most a third": "verdict"}


def main() -> None:
    options = _parse()
    rows: list[dict[str, object]] = []
    with open_context(options.backend) as context:
        facts = machine.here() | {"renderer": context.renderer, "size": f"{options.size}x{options.size}",
                                  "samples a pixel of the references": options.spp, "times of plain": options.times}
        with machine.until_stopped():
            for model in options.models:
                for environment in options.env:
                    row = _row(context, model, environment, options)
                    if row:
                        rows.append(row)
                        print(row if options.prepare else _line(row), flush=True)
    if options.prepare:
        return
    rows.sort(key=lambda row: options.env.index(row["environment"]))
    loads = [row["load"] for row in rows]
    facts |= {"load average": f"{min(loads)} to {max(loads)}"} if rows else {}
    text = ["# The best of the raster, and plain image-based light", "", *tracing.table(rows, COLUMNS), "",
            *summary(rows), "", *by_family(rows, options.times)]
    tracing.keep("reach", facts, rows, text, options.results)


def _row(context: Context, model: str, environment: str, options: argparse.Namespace) -> dict[str, object]:
    """Empty where the model cannot be shown, which is told."""
    try:
        scene = load_scene(corpus.model(model))
        row = measure(context, scene.relit(environment=load_environment(corpus.environment(environment))), options)
    except (InputError, FileNotFoundError) as error:
        print(f"{error}: left out")
        return {}
    return {"model": Path(model).stem, "environment": environment, "load": round(os.getloadavg()[0], 1)} | row


def measure(context: Context, scene: Scene, options: argparse.Namespace) -> dict[str, object]:
    """What one scene's row tells; raises InputError where nothing of it fills a pixel."""
    size = options.size, options.size
    camera, base = Camera.framing(scene.center, scene.radius, 1.0), Settings(background="none")
    truth = Truth.of(context, scene, camera, size, options.spp, options.references)
    if options.prepare:
        return {"floor": truth.floor, "direct": truth.direct}
    frames = Frames(context, scene, camera, base, size, most=1.5 * options.times)
    try:
        measured, left_out = _measure_all(frames, ladder(scene, base).raster, options.seconds)
        errors = {method.slug: truth.error(record.picture) for method, record in measured}
        relmse = {slug: pair[0] for slug, pair in errors.items()}
        best, (plain_ms, best_ms) = _nearest(frames, measured, relmse, options)
    finally:
        frames.release()
    plain, found = errors[PLAIN.slug], errors[best.slug]
    methods = [{"family": method.title, "label": method.label, "relmse": errors[method.slug][0],
                "trimmed": errors[method.slug][1], **record.facts} for method, record in measured]
    return {"plain": plain[0], "plain_ms": plain_ms, "best": best.label, "error": found[0], "ms": best_ms,
            "times": best_ms / plain_ms, "floor": truth.floor, "gain": _gain(plain[0], found[0], truth.floor),
            "trimmed_gain": _gain(plain[1], found[1], truth.trimmed_floor), "direct": truth.direct,
            "verdict": verdict(plain[0], found[0], truth.floor), "methods": methods, "left_out": left_out}


def verdict(plain: float, best: float, floor: float) -> str:
    """Whether `best` is at most a third of `plain`, as far as the reference's noise lets one tell."""
    if plain <= floor:
        return "at the noise"
    return "yes" if GAIN * best <= plain else "no"


def _gain(plain: float, best: float, floor: float) -> float:
    """How many times the error of `best` plain's is; none is known better than a tenth of the floor taken off it."""
    return plain / max(best, floor / 10, 1e-9)


def _measure_all(frames: Frames, methods: tuple[Method, ...],
                 seconds: float) -> tuple[list[tuple[Method, Record]], list[str]]:
    """Draw and time each method that is predicted to fit into so many seconds; and which were left out."""
    measured: list[tuple[Method, Record]] = []
    left_out: list[str] = []
    given_up: set[tuple[str, str]] = set()
    for method in sorted(methods, key=_promise):
        spent = sum(record.seconds for _, record in measured)
        if method.family in given_up or reason_against(method, measured, seconds - spent, frame_effort(seconds)):
            left_out.append(method.label)
            continue
        measured.append((method, frames.measure(method)))
        if method.slug in frames.too_slow:  # others of the family take longer
            given_up.add(method.family)
    return measured, left_out


def _promise(method: Method) -> tuple[int, int]:
    """Sorts methods: plain comes first, by which others are too slow or not; then what does more about the environment
    than plain, with the smoothest edges first; and last what takes many shadow maps to be drawn."""
    antialias = str(method.changes.get("antialias", "none"))
    smooth = -_EDGES.index(antialias) if antialias in _EDGES else 0
    if method == PLAIN:
        return 0, 0
    if method.changes.get("environment_shadows", "off") in ("256", "1024"):
        return 3, smooth
    return (2 if method.name in ("phong", "lights", PLAIN.name) else 1), smooth


def _nearest(frames: Frames, measured: list[tuple[Method, Record]], errors: dict[str, float],
             options: argparse.Namespace) -> tuple[Method, tuple[float, float]]:
    """The method of least error that is in time, and milliseconds of plain and of it, drawn in turn."""
    for method, _ in sorted(measured, key=lambda pair: errors[pair[0].slug]):
        if method.slug in frames.too_slow:
            continue
        plain_ms, ms = frames.in_turn(method, options.rounds)
        if ms <= options.times * plain_ms:
            break
    return method, (plain_ms, ms)  # plain itself is in time


def _line(row: dict[str, object]) -> str:
    return (f"{row['model']:27} {row['environment']:18} plain {row['plain']:.4f} in {row['plain_ms']:.1f} ms, "
            f"{row['error']:.4f} in x{row['times']:.1f} by {row['best']}: gain {row['gain']:.1f} (trimmed "
            f"{row['trimmed_gain']:.1f}), {row['verdict']}; floor {row['floor']:.4f}, load {row['load']}")


def _parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.reach", description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("models", nargs="*", metavar="MODEL", help="files, or names of the corpus")
    parser.add_argument("--env", nargs="+", default=list(ENVIRONMENTS), help="files, names of the corpus or of ours")
    parser.add_argument("--size", type=int, default=256)
    parser.add_argument("--spp", type=int, default=128, help="samples a pixel of a reference, both halves (128)")
    parser.add_argument("--times", type=float, default=10.0, help="of plain's time that a method may take (10)")
    parser.add_argument("--seconds", type=float, default=15.0, help="for all methods of one scene (15)")
    parser.add_argument("--rounds", type=int, default=2, help="how often plain and the nearest are drawn in turn (2)")
    parser.add_argument("--references", type=Path, metavar="DIR", help="keep references there, and take those that are")
    parser.add_argument("--prepare", action="store_true", help="make the references and no more")
    parser.add_argument("--backend", default="auto")
    parser.add_argument("--results", type=Path, default=shot.REPOSITORY / "benchmarks/results")
    options = parser.parse_args()
    options.models = options.models or corpus.present(MODELS) or [str(shot.REPOSITORY / "assets/demo.glb")]
    return options


if __name__ == "__main__":
    main()
