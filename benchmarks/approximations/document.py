"""Measures the pieces: what approximations.json holds."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from importlib.metadata import version
from typing import Any

import numpy as np

from viewer.base.progress import Progress
from viewer.gpu.context import Context
from viewer.measure.report.pareto import SAME
from viewer.measure.report.timing import Effort, Timing

from . import curves, dfg, floats, fresnel, irradiance, prefilter, split_sum
from .device import SIDE, THOROUGH, Device
from .piece import Piece, Variant

Document = dict[str, Any]
SAME_COST = 0.05
"""Costs that differ by less than this share count as equal,"""
LEAST_NS = 0.25
"""and so do costs that differ by less than this, in nanoseconds: about the cost of a clamp or two."""
PIECES: tuple[Callable[[], Piece], ...] = (
    dfg.dfg_piece, split_sum.dielectric_piece, split_sum.metal_piece, prefilter.lookup_piece, prefilter.bake_piece,
    irradiance.irradiance_piece, floats.storage_piece, fresnel.dielectric_piece, fresnel.metal_piece,
    curves.distribution_piece, curves.masking_piece, curves.srgb_piece, curves.equirect_piece,
)


def measure_pieces(context: Context, pieces: Sequence[Callable[[], Piece]] = PIECES, effort: Effort = THOROUGH,
                   progress: Progress | None = None) -> Document:
    """approximations.json, of these pieces."""
    started = time.perf_counter()
    device = Device(context)
    found = []
    for make in pieces:
        piece = make()
        if progress is not None:
            progress.step(piece.title)
        found.append(measure_piece(device, piece, effort))
    device.release()
    return {
        "device": context.gl.info["GL_RENDERER"],
        "backend": context.backend,
        "version": version("pbr-viewer"),
        "clock": "processor time of all cores" if context.is_software else "wall clock",
        "evaluations_a_draw": SIDE * SIDE,
        "measured_s": time.perf_counter() - started,
        "pieces": found,
    }


def measure_piece(device: Device, piece: Piece, effort: Effort = THOROUGH) -> Document:
    """A piece's entry: errors, costs, Pareto front, and which alternatives are better than the renderer's way."""
    timed = [variant for variant in piece.variants if variant.cost_ns is None]
    costs = iter(device.costs([v.kernels[0] for v in timed], piece.cases[0].parameters, effort))
    rows = []
    for variant in piece.variants:
        errors = np.concatenate([np.ravel(case.error(device.values(kernel, case.parameters)))
                                 for kernel, case in zip(variant.kernels, piece.cases, strict=True)])
        cost = next(costs) if variant.cost_ns is None else Timing(variant.cost_ns, variant.cost_ns, variant.cost_ns, 1)
        rows.append(_row(variant, errors, cost))
    for row in rows:
        row["pareto"] = not any(dominates(other, row) for other in rows)
    return {"name": piece.name, "title": piece.title, "over": piece.over, "unit": piece.unit, "truth": piece.truth,
            "per": piece.per, "reason": piece.reason, "variants": rows, "better": better_than_default(rows)}


def _row(variant: Variant, errors: np.ndarray, cost: Timing) -> Document:
    # The cost of almost nothing is a difference of two times that may be negative.
    cost = replace(cost, **{name: max(getattr(cost, name), 0.0) for name in ("median", "p10", "p90")})
    rms = float(np.sqrt(np.mean(np.square(errors, dtype=np.float64))))
    return {"name": variant.name, "source": variant.source, "is_default": variant.is_default,
            "error": {"rms": rms, "max": float(np.abs(errors).max())}, "cost_ns": cost.to_json(),
            "bytes": variant.size, "bake_s": variant.bake_s}


def dominates(one: Mapping[str, Any], other: Mapping[str, Any]) -> bool:
    """Whether `one` is at least as good as `other` in cost, error and size, and better in one of them.

    RMS errors are the same within SAME of themselves, costs within SAME_COST and LEAST_NS.
    """
    slack = SAME_COST * other["cost_ns"]["median"] + LEAST_NS
    cost = one["cost_ns"]["median"] - other["cost_ns"]["median"]
    error, least = one["error"]["rms"], other["error"]["rms"]
    if cost > slack or error > least * (1 + SAME) or one["bytes"] > other["bytes"]:
        return False
    return cost < -slack or error < least * (1 - SAME) or one["bytes"] < other["bytes"]


def better_than_default(rows: Sequence[Mapping[str, Any]]) -> list[str]:
    """The names of those that dominate the default, and have no larger error anywhere either."""
    default = next(row for row in rows if row["is_default"])
    return [row["name"] for row in rows
            if dominates(row, default) and row["error"]["max"] <= default["error"]["max"] * (1 + SAME)]
