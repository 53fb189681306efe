"""How large the wavefronts of a picture are, and how often it is checked which of their blocks are done."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from ...gpu.context import Context
from ..plan import TracePlan
from .wavefront import Wavefront

SOFTWARE_SIDE, DEVICE_SIDE = 16, 32
"""Most blocks of a wavefront along each side, for software OpenGL and for a GPU."""
SMALL_SIDE = 8
"""The same for software OpenGL in two cases. In scenes with scattering some paths have hundreds of collisions, and in a
smaller wavefront fewer texels wait for them, and what is read and drawn stays in the caches. In an interactive view
input waits for a round of the wavefronts, which takes a quarter of the time then, with slightly fewer rays a second."""
MORE_HOMES = 2
"""How many times as many blocks as others a sorted wavefront has if work items may have paths for few pixels of their
tiles, so that their paths fill it. Layers are drawn over all homes, and with them it has no more."""
DEVICE_CHECK_INTERVAL = 4
"""Iterations of a wavefront on a GPU between two checks which blocks are done, since each check waits for the GPU."""


class WavefrontMaker:
    """Makes wavefronts for a picture of so many `blocks` of work in all, half of which one wavefront need hold."""

    def __init__(self, context: Context, plan: TracePlan, blocks: int, is_interactive: bool = False) -> None:
        software = SMALL_SIDE if plan.has_scattering or is_interactive else SOFTWARE_SIDE
        self._context, self._plan = context, plan
        self._columns = software if context.is_software else DEVICE_SIDE
        self._rows = min(math.ceil(blocks / self._columns / 2), self._columns)
        self.check_interval = 1 if context.is_software else DEVICE_CHECK_INTERVAL

    def make(self, has_layers: bool = False, sees_backs: bool = False, is_sorted: bool = False,
             chooses: bool = False, covered: NDArray[np.bool_] | None = None) -> Wavefront:
        plan = self._plan
        return Wavefront(self._context, self._columns, self._rows, plan.state_textures, has_layers,
                         plan.has_along, plan.has_grids, sees_backs, is_sorted, chooses,
                         MORE_HOMES if is_sorted and (chooses or covered is not None) and not has_layers else 1,
                         covered if is_sorted else None, is_sorted and plan.knows_classes)
