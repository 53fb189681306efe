"""Chooses what is drawn of the grids of an OpenVDB file."""

from __future__ import annotations

from pathlib import Path

from ...errors import InputError
from ..scene import Scene
from ..volume import Volume
from .header import Grid, read_grids
from .stream import Stream
from .voxels import Facts, about, read_voxels


def load_vdb(path: Path, data: bytes) -> Scene:
    """The scene of an OpenVDB file: one volume, or none if its grid has no active voxels.

    Drawn is the grid `density`; if there is none, the first fog volume, or the first grid of single numbers. Raises
    InputError for a file that is broken or has no such grid.
    """
    stream = Stream(path, data)
    grids = read_grids(stream)
    drawn, warnings = _drawn(path, grids)
    volumes: list[Volume] = []
    trees: dict[int, Facts] = {}
    for grid in sorted(grids, key=lambda grid: grid is not drawn):
        if grid.tree not in trees:
            trees[grid.tree], volume = read_voxels(stream, grid, grid is drawn, warnings)
            volumes += [volume] if volume is not None else []
    told = [about(grid) | trees[grid.tree] for grid in grids]  # instances share a tree
    return Scene(path.stem, volumes=tuple(volumes), warnings=tuple(warnings), facts={"format": "VDB", "grids": told})


def _drawn(path: Path, grids: list[Grid]) -> tuple[Grid, list[str]]:
    """The grid that is drawn, and warnings about the choice."""
    able = [grid for grid in grids if not _refusal(grid)]
    if not able:
        reasons = "; ".join(f"'{grid.name}' {_refusal(grid)}" for grid in grids)
        raise InputError(path, "", f"has no grid of densities: {reasons or 'there are no grids'}")
    drawn = min(able, key=lambda grid: (grid.name.lower() != "density", grid.text("class") != "fog volume"))
    warnings = []
    if drawn.name.lower() != "density":
        warnings.append(f"there is no grid 'density'; '{drawn.name}' is taken for it")
    others = ", ".join(f"'{grid.name}'" for grid in grids if grid is not drawn)
    if others:
        warnings.append(f"only the grid '{drawn.name}' is drawn, without {others}")
    return drawn, warnings


def _refusal(grid: Grid) -> str:
    """Why the grid cannot be drawn, "" if it can."""
    if grid.text("class") == "level set":
        return "is a level set, the distance to a surface; only fog volumes are drawn"
    if "ptdataidx" in grid.type:
        return "holds points; only fog volumes are drawn"
    if grid.dtype is None:
        return f"is of the type {grid.type}, which is not read"
    if grid.index_to_world is None:
        return "has a transform that is not linear, which is not read"
    return "" if grid.channels == 1 else f"has {grid.channels} numbers in each voxel; a density is one"
