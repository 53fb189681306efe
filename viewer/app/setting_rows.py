"""Rows of the panel that show a setting and change it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from imgui_bundle import imgui

from ..interact.state import ViewState
from ..plan.unused import without_effect
from ..scene.scene import Scene
from ..settings import Settings, ignored, setting_choices, setting_meanings
from .tips import tip_of
from .widgets import combo, row, tooltip

_LABELS = {
    "ggx": "GGX", "beckmann": "Beckmann", "blinn-phong": "Blinn–Phong", "smith": "Smith, height-correlated",
    "smith-separable": "Smith, separable", "v-cavity": "V-cavity", "none": "None", "schlick": "Schlick",
    "exact": "Exact", "phong": "Phong", "all": "All", "uniform-diffuse": "Uniform diffuse", "specular": "Specular",
    "directional-diffuse": "Directional diffuse", "neutral": "Khronos PBR Neutral", "agx": "AgX", "aces": "ACES (Hill)",
    "auto": "Automatic", "msaa-2": "MSAA 2×", "msaa-4": "MSAA 4×", "msaa-8": "MSAA 8×",
    "deferred-4": "Deferred 4×", "ssaa-4": "SSAA 4×", "ssaa-9": "SSAA 9×", "ssaa-16": "SSAA 16×", "gtao": "GTAO",
    **{count: f"{count} lights" for count in ("16", "64", "256", "1024")},
    "off": "Off", "fast": "Fast", "raster": "Real-time picture",
    "mis": "Both (MIS)", "bsdf": "BSDF sampling only", "lights": "Light sampling only",
    "environment": "Environment only", "screen": "Screen space", "traced": "Traced",
    "baked": "Baked", "single": "Once", "multiple": "Many times",
    "quarter": "A quarter", "ninth": "A ninth", "sixteenth": "A sixteenth",
    "charlie": "Charlie", "zeltner": "Zeltner et al.", "slab": "Slab",
    "photons": "Photons", "estimated": "Estimated", "cotton": "Cotton", "wool": "Wool", "silk": "Silk",
}


class SettingRows:
    """`scale` is the desktop's. A setting has no row if the scene has nothing that it is about, or if no mode that is
    shown uses it."""

    def __init__(self, state: ViewState) -> None:
        self._state = state
        self.scale = 1.0
        self._without: set[str] = set()
        self._known: tuple[Scene | None, Settings | None, tuple[str, ...]] = (None, None, ())

    def begin(self, scale: float) -> None:
        """Begin a frame of the panel."""
        self.scale, state = scale, self._state
        shown = state.scene, state.at_rest, state.modes
        if shown != self._known:
            # What another row switches off stays: a row that is gone after a choice in it could not be changed back.
            free = replace(state.at_rest, indirect="baked", show="shaded")
            self._without = without_effect(state.scene, free) | set(ignored(*state.modes))
            self._known = shown

    def row(self, label: str, setting: str = "") -> None:
        row(label, self.scale, tip_of(label, setting))

    def choice(self, label: str, name: str) -> None:
        """A row for a setting with choices, if it can change the picture."""
        if name not in self._without:
            self.combo(label, name, setting_choices()[name])

    def combo(self, label: str, name: str, values: Sequence[str]) -> None:
        self.row(label, name if name in setting_meanings() else "")
        current = values.index(getattr(self._state.at_rest, name))
        index = combo(name, current, [_LABELS.get(value, value) for value in values])
        if index is not None:
            self._state.choose(name, values[index])

    def switch(self, label: str, name: str) -> None:
        """A check box for a setting that is on or off, if it can change the picture."""
        if name in self._without:
            return
        changed, on = imgui.checkbox(label, getattr(self._state.settings, name) == "on")
        tooltip(tip_of(label, name))
        if changed:
            self._state.choose(name, "on" if on else "off")
