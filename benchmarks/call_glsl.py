"""How long a million evaluations of a GLSL function take: `python -m benchmarks.call_glsl`."""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable

import numpy as np

from viewer.gpu.call import call_glsl
from viewer.gpu.context import open_context
from viewer.measure.check.lobes import LOBES

COUNT = 1_000_000
ROUNDS = 9


def main() -> None:
    argparse.ArgumentParser(prog="python -m benchmarks.call_glsl", description=__doc__).parse_args()
    rng = np.random.default_rng(0)
    NoV, NoL, alpha = rng.random((3, COUNT), np.float32)
    wo = np.stack([np.sqrt(1 - NoV**2), 0 * NoV, NoV], axis=-1)
    wi = np.stack([0 * NoL, np.sqrt(1 - NoL**2), NoL], axis=-1)
    u = rng.random((COUNT, 3), np.float32)
    lobes = {lobe.name: lobe for lobe in LOBES}
    metal = {"f0": [1.0, 0.8, 0.3], "tint": 1.0, "alpha": np.stack([alpha, alpha], axis=-1)}
    glass = {"eta": 1.5, "alpha": np.stack([alpha, alpha], axis=-1)}
    with open_context() as context:
        print(f"{COUNT:,} evaluations, {context.renderer}; median and range of {ROUNDS} after one to compile, in ms")
        cases: dict[str, Callable[[], object]] = {
            "v_smith_ggx": lambda: call_glsl("bsdf/ggx.glsl", "v_smith_ggx", NoV=NoV, NoL=NoL, alpha=alpha,
                                             context=context),
            "metal_eval": lambda: lobes["metal"].eval(metal, wo, wi, context),
            "metal_sample": lambda: lobes["metal"].sample(metal, wo, u, context),
            "dielectric_sample": lambda: lobes["dielectric"].sample(glass, wo, u, context),
        }
        for name, call in cases.items():
            call()
            times = sorted(_milliseconds(call) for _ in range(ROUNDS))
            print(f"{name:18} {times[ROUNDS // 2]:6.0f}  ({times[0]:.0f} to {times[-1]:.0f})")


def _milliseconds(call: Callable[[], object]) -> float:
    start = time.perf_counter()
    call()  # ends with the results in memory, so the GPU has finished
    return 1e3 * (time.perf_counter() - start)


if __name__ == "__main__":
    main()
