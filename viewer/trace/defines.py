"""The defines by which GLSL gets the numbers of viewer/trace/layout.py and viewer/trace/kinds.py."""

from __future__ import annotations

from collections.abc import Mapping

from ..plan.bsdf_switches import bsdf_switches
from ..settings import Settings
from . import layout
from .kinds import KINDS

_UNSIGNED = {"INSTANCE_MASK", "FREE", "MISS", "LIGHT_LEAF"}
"""Constants of shaders/trace/hit.glsl and light_tree.glsl: a define is no unsigned number."""
_CONSTANTS: dict[str, float] = {
    **{name: value for name, value in vars(layout).items()
       if name.isupper() and isinstance(value, (int, float)) and name not in _UNSIGNED},
    **{f"KIND_{kind.name.upper()}": kind.number for kind in KINDS},
}


def shader_defines(switches: Mapping[str, int] | None = None) -> dict[str, float]:
    """The defines of a program of shaders/trace: its own `switches`, and the shared numbers."""
    switches = switches or {}
    far = {"FAR": 2 * layout.MEDIA_REACH if switches.get("HAS_SCATTERING") else layout.FAR}
    return {**_CONSTANTS, **far, **layout.vertex_layout(switches), **layout.medium_layout(switches),
            "SORTED": 0, **switches}


def surface_defines(switches: Mapping[str, int]) -> dict[str, float]:
    """Those of a program that asks what shadow rays meet. What panes transmit (shaders/trace/pane.glsl) is the same
    whatever the settings of the BSDF are, but their GLSL stands in files that have switches of these."""
    return shader_defines(bsdf_switches(Settings()) | dict(switches))
