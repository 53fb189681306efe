"""Our pictures against another renderer's: `python -m benchmarks.truth`.

Every case in the folder is rendered in two halves of different seeds, which tell how far noise alone would put the two
apart. Without a bias relMSE is that floor, what the variances of both pictures make; our bound is 1.5 times it, and
0.5 % in mean radiance.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from viewer.gpu.context import open_context
from viewer.measure.compare.relmse import Halves
from viewer.trace.tracer import Tracer

from . import mitsuba_scene, tracing, truth_cases
from .shot import REPOSITORY

COLUMNS = {"case": "case", "by": "by", "size": "size", "spp": "spp:.0f", "relMSE": "relmse:.2e", "floor": "floor:.2e",
           "relMSE / floor": "excess:.3f", "mean / reference": "mean_ratio:.5f", "± of noise": "mean_sigma:.5f",
           "worst block, sigma": "worst:.1f", "s": "seconds:.1f", "Mray/s": "mega_rays:.2f"}


def main() -> None:
    options = _parse()
    rows: list[dict[str, object]] = []
    with open_context() as context:
        tracer = Tracer(context)
        for name in options.only.split(",") if options.only else truth_cases.names(options.folder):
            case = truth_cases.load_case(name, options.folder).small(options.reduce)
            both, shot = tracing.halves(tracer, case.scene, case.camera, case.size, seed=options.seed,
                                        spp=max(1, options.spp // 2), **case.settings)
            rows.append(_row(case, "pbr-viewer", both) | shot.to_json() | {
                "mega_rays": shot.rays / shot.seconds / 1e6})
            if options.mitsuba and mitsuba_scene.is_installed():
                theirs = mitsuba_scene.convert(case.scene, case.camera, case.size)
                pictures = [mitsuba_scene.render(theirs, max(1, options.spp // 2), seed) for seed in (1, 2)]
                rows.append(_row(case, "Mitsuba", Halves(*pictures)) | {"spp": options.spp})
                rows.append(_row(case, "each other", both, Halves(*pictures)) | {"spp": options.spp})
        facts = tracing.conditions(tracer)
    tracing.keep(options.name, facts, rows, ["# Against an independent renderer", "", *tracing.table(rows, COLUMNS)],
                 options.results)


def _row(case: truth_cases.Case, by: str, both: Halves, theirs: Halves | None = None) -> dict[str, object]:
    """`both` against the case's reference, or against a picture of about the same sample count."""
    reference, floor = case.reference, case.floor
    if theirs is not None:
        reference, floor = theirs.mean, theirs.floor(case.reference)
    found = both.against(reference, floor)
    scores = both.block_scores(reference, floor, 16)
    return {"case": case.name, "by": by, "size": "{}x{}".format(*case.size), "relmse": found.relmse,
            "floor": found.floor, "excess": found.excess, "mean_ratio": found.mean_ratio,
            "mean_sigma": found.mean_sigma, "worst": float(abs(scores).max())}


def _parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.truth", description=__doc__)
    parser.add_argument("folder", nargs="?", type=Path, default=truth_cases.FOLDER, help="a folder of cases")
    parser.add_argument("--spp", type=int, default=256, help="samples a pixel, of both halves together (256)")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--reduce", type=int, default=1, metavar="N", help="render at 1/N of the size (1)")
    parser.add_argument("--only", default="", help="names of cases, with commas")
    parser.add_argument("--mitsuba", action="store_true", help="render Mitsuba's side as well, with as many samples")
    parser.add_argument("--results", type=Path, default=REPOSITORY / "benchmarks/results")
    parser.add_argument("--name", default="truth", help="of the files in --results (truth)")
    return parser.parse_args()


if __name__ == "__main__":
    main()
