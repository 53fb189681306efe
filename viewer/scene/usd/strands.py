"""BasisCurves of a stage as strands in world coordinates; runs in the other process."""

from __future__ import annotations

from typing import Any

import numpy as np
from pxr import Usd, UsdGeom

Arrays = dict[str, np.ndarray]
_PIECES = 8
"""Straight pieces of a segment of a kind of curve that viewer.scene.curves does not have."""
_BASES = {  # rows: 1, t, t^2, t^3; columns: the four points
    "bezier": np.array([[1, 0, 0, 0], [-3, 3, 0, 0], [3, -6, 3, 0], [-1, 3, -3, 1]], float),
    "catmullRom": np.array([[0, 2, 0, 0], [-1, 0, 1, 0], [2, -5, 4, -1], [-1, 3, -3, 1]], float) / 2,
}
_OWN = {("bspline", "nonperiodic"): "b-spline", ("bspline", "pinned"): "b-spline", ("bspline", "periodic"): "b-spline",
        ("catmullRom", "pinned"): "catmull-rom", ("catmullRom", "periodic"): "catmull-rom"}
"""Basis and wrap, and the kind of viewer.scene.curves that is the same."""


def read_strands(prim: Usd.Prim, time: Usd.TimeCode) -> tuple[str, bool, Arrays]:
    """Kind, whether the strands are closed, and `points`, `widths` (n,), `offsets` and perhaps `colors` of a set.

    Raises ValueError for arrays that do not fit together.
    """
    curves = UsdGeom.BasisCurves(prim)
    points = np.asarray(curves.GetPointsAttr().Get(time) or (), np.float64).reshape(-1, 3)
    counts = np.asarray(curves.GetCurveVertexCountsAttr().Get(time) or (), np.int64)
    if counts.min(initial=0) < 0 or counts.sum() != len(points):
        raise ValueError(f"has at {prim.GetPath()} curveVertexCounts for {counts.sum()} points, and there are "
                         f"{len(points)}")
    is_cubic = curves.GetTypeAttr().Get(time) == UsdGeom.Tokens.cubic
    basis = str(curves.GetBasisAttr().Get(time)) if is_cubic else "linear"
    wrap = str(curves.GetWrapAttr().Get(time))
    rows = {"points": points, "widths": _by_point(curves.GetWidthsAttr().Get(time), curves.GetWidthsInterpolation(),
                                                  counts, 1)}
    color = curves.GetDisplayColorPrimvar()
    if color and color.HasAuthoredValue():
        rows["colors"] = _by_point(color.ComputeFlattened(time), color.GetInterpolation(), counts, 3)
    strands = np.split(np.concatenate([rows[name] for name in rows], axis=1), np.cumsum(counts)[:-1])
    made = [_made(strand, basis, wrap) for strand in strands]
    made = [strand for strand in made if len(strand) >= (3 if wrap == "periodic" else 2)]
    joined = np.concatenate(made) if made else np.zeros((0, 4))
    arrays = {"points": joined[:, :3], "widths": joined[:, 3],
              "offsets": np.cumsum([0, *(len(strand) for strand in made)])}
    if "colors" in rows:
        arrays["colors"] = joined[:, 4:]
    kind = _OWN.get((basis, wrap), "linear")
    return kind, wrap == "periodic" and (basis == "linear" or kind != "linear"), arrays


def _made(strand: np.ndarray, basis: str, wrap: str) -> np.ndarray:
    """The points of a strand (n, k), as one of the kinds of viewer.scene.curves; none if it has too few."""
    if basis == "linear" or (basis, wrap) in _OWN:
        if basis == "bspline" and wrap == "pinned" and len(strand) >= 2:  # further points, so that it reaches its ends
            strand = np.concatenate([[2 * strand[0] - strand[1]], strand, [2 * strand[-1] - strand[-2]]])
        return strand if basis != "bspline" or wrap == "periodic" or len(strand) >= 4 else strand[:0]
    if basis not in _BASES:
        return strand[:0]
    step = 3 if basis == "bezier" else 1
    if wrap == "periodic":
        strand = np.concatenate([strand, strand[:1]])
    first = np.arange(0, len(strand) - 3, step)
    if not len(first):
        return strand[:0]
    groups = strand[first[:, None] + np.arange(4)]  # (segments, 4, k)
    t = np.linspace(0, 1, _PIECES + 1)
    weights = t[:, None] ** np.arange(4) @ _BASES[basis]
    points = np.einsum("tp,spk->stk", weights, groups)
    return np.concatenate([points[:, :-1].reshape(-1, strand.shape[1]), points[-1, -1:]])


def _by_point(values: Any, interpolation: str, counts: np.ndarray, columns: int) -> np.ndarray:
    """(n, columns) float64 of each point; the first value for all where their number does not fit, 0 without any.

    Values that vary along segments have fewer than there are points; they are spread evenly over the strand.
    """
    total = int(counts.sum())
    given = np.asarray(() if values is None else values, np.float64).reshape(-1, columns)
    if len(given) == total and interpolation != UsdGeom.Tokens.uniform:
        return given
    if len(given) == len(counts) and interpolation == UsdGeom.Tokens.uniform:
        return np.repeat(given, counts, axis=0)
    ends = [len(given) // len(counts)] * len(counts) if len(counts) and len(given) % len(counts) == 0 else []
    if interpolation == UsdGeom.Tokens.varying and ends and ends[0] >= 1:
        parts = np.split(given, np.cumsum(ends)[:-1])
        return np.concatenate([_stretched(part, count) for part, count in zip(parts, counts)])
    return np.broadcast_to(given[0] if len(given) else np.zeros(columns), (total, columns))


def _stretched(values: np.ndarray, count: int) -> np.ndarray:
    at = np.linspace(0, len(values) - 1, count)
    return np.stack([np.interp(at, np.arange(len(values)), column) for column in values.T], axis=1)
