"""Makes tests/golden/path, the golden images of the path tracer, anew: look at them before they are committed.

    python tests/golden/make_path_goldens.py [NAME...]

Each of the pictures that a golden image is made of is judged against the mean of the others, by the test's own limits:
what that finds is listed, and more than one in a hundred that fail are an error, for then tails are too heavy. Takes
a minute or two a scene.
"""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

import numpy as np
from path_cases import CASES, SIZE, PathCase
from path_golden import BLOCK, FOLDER, PICTURES, PathGolden

from viewer.gpu.context import open_context
from viewer.trace.tracer import Tracer

FIRST_SEED = 1000
"""Far from those of the tests."""


def pictures(tracer: Tracer, case: PathCase) -> list[np.ndarray]:
    scene, camera = case.make()
    return [tracer.render(scene, camera, case.with_seed(FIRST_SEED + k), SIZE).linear[..., :3] for k in range(PICTURES)]


def main(names: list[str]) -> int:
    FOLDER.mkdir(exist_ok=True)
    failed = 0
    print("| scene | samples | detects | picture: most | blocks: most | pixels: most beyond | fail of "
          f"{PICTURES} |\n|---|---|---|---|---|---|---|")
    with open_context() as context:
        tracer = Tracer(context, use_cache=False)
        for case in CASES:
            if names and case.name not in names:
                continue
            made = pictures(tracer, case)
            golden = PathGolden.of(made)
            golden.save(case.name)
            others = [(PathGolden.of(made[:k] + made[k + 1:]), picture) for k, picture in enumerate(made)]
            problems = sum(other.problem(picture) is not None for other, picture in others)
            failed += problems
            whole, blocks = (max(other.worst(picture, block) for other, picture in others)
                             for block in (SIZE[0], BLOCK))
            pixels = max(other.failing_pixels(picture) for other, picture in others)
            print(f"| {case.name} | {case.spp} | {golden.detectable():.2%} | {whole:.1f} | {blocks:.1f} "
                  f"| {pixels:.2%} | {problems} |", flush=True)
        tracer.release()
    return int(failed > 0.01 * PICTURES * len(names or CASES))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
