"""The defines by which GLSL gets the numbers of viewer/trace/layout.py and viewer/trace/kinds.py."""

from __future__ import annotations

from collections.abc import Mapping

from ..plan.bsdf_switches import bsdf_switches
from ..settings import Settings
from . import layout
from .kinds import KINDS

_CONSTANTS: dict[str, float] = {
    "TILE": layout.TILE,
    "IDLE": layout.IDLE, "IN_FLIGHT": layout.IN_FLIGHT, "ENDED": layout.ENDED,
    "KIND_SHIFT": layout.KIND_SHIFT, "NO_KIND": layout.NO_KIND,
    **{f"KIND_{kind.name.upper()}": kind.number for kind in KINDS},
    "CLASS_IDLE": layout.CLASS_IDLE, "CLASS_ENDED": layout.CLASS_ENDED, "CLASS_FIRST_HIT": layout.CLASS_FIRST_HIT,
    "CLASS_SHADE": layout.CLASS_SHADE, "CLASS_MEDIUM": layout.CLASS_MEDIUM, "CLASS_AIRLIGHT": layout.CLASS_AIRLIGHT,
    "CLASS_FIRST_COLLISION": layout.CLASS_FIRST_COLLISION,
    "CLEARANCE_STEPS": layout.CLEARANCE_STEPS, "MEDIA_REACH": layout.MEDIA_REACH, "MOST_STEPS": layout.MOST_STEPS,
    "THINS_FROM": layout.THINS_FROM, "THINS_EVERY": layout.THINS_EVERY,
    "HURRIES_FROM": layout.HURRIES_FROM, "HURRIES_EVERY": layout.HURRIES_EVERY,
    "GUIDE_PLACES": layout.GUIDE_PLACES, "GUIDE_CELLS": layout.GUIDE_CELLS,
    "GUIDE_STEPS": layout.GUIDE_STEPS,
    "INSTANCE_TEXELS": layout.INSTANCE_TEXELS,
    "VOLUME_TEXELS": layout.VOLUME_TEXELS, "FIBRE_TEXELS": layout.FIBRE_TEXELS,
    "LIGHT_NODE_TEXELS": layout.LIGHT_NODE_TEXELS, "MOST_LIGHT_LEVELS": layout.MOST_LIGHT_LEVELS,
    "LIGHT_COSINE_STEPS": layout.LIGHT_COSINE_STEPS, "LIGHT_FLAG_SHIFT": layout.LIGHT_FLAG_SHIFT,
    "LIGHT_LAMP": layout.LIGHT_LAMP, "LIGHT_TWO_SIDED": layout.LIGHT_TWO_SIDED, "LIGHT_NARROW": layout.LIGHT_NARROW,
    "LIGHT_REACH_STEPS": layout.LIGHT_REACH_STEPS, "LIGHT_REACH_LOW": layout.LIGHT_REACH_LOW,
    "FLAG_SEE_THROUGH": layout.SEE_THROUGH, "FLAG_MIRRORED": layout.MIRRORED,
    "FLAG_DOUBLE_SIDED": layout.DOUBLE_SIDED, "FLAG_UNLIT": layout.UNLIT, "FLAG_THIN": layout.THIN,
    "FLAG_PANE": layout.PANE,
    "MAP_TEXELS": layout.MAP_TEXELS, "WRAP_REPEAT": layout.WRAPS["repeat"], "WRAP_CLAMP": layout.WRAPS["clamp"],
    "MAP_WRAP_BITS": layout.MAP_WRAP_BITS, "MAP_NEAREST": layout.MAP_NEAREST, "MAP_SECOND_UV": layout.MAP_SECOND_UV,
    "MAP_TRANSFORMED": layout.MAP_TRANSFORMED, "MAP_ROLE_SHIFT": layout.MAP_ROLE_SHIFT,
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
