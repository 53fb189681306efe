"""The panel at the right of the window: all settings, and information about model and frame."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import cache

import numpy as np
from imgui_bundle import imgui

from ..interact.state import ViewState, scene_facts
from ..scene.color import linear_to_srgb, srgb_to_linear
from ..scene.environment_files import load_environment
from ..scene.environment_presets import PRESETS
from ..scene.light import Light
from ..settings import ignored, setting_choices
from .overlay import MODE_NAMES

WIDTH = 310.0
"""In window coordinates, before the desktop's scale."""
_LABEL_WIDTH = 104.0
_LABELS = {
    "ggx": "GGX", "beckmann": "Beckmann", "blinn-phong": "Blinn–Phong", "smith": "Smith, height-correlated",
    "smith-separable": "Smith, separable", "v-cavity": "V-cavity", "none": "None", "schlick": "Schlick",
    "exact": "Exact", "phong": "Phong", "all": "All", "uniform-diffuse": "Uniform diffuse", "specular": "Specular",
    "directional-diffuse": "Directional diffuse", "neutral": "Khronos PBR Neutral", "agx": "AgX", "aces": "ACES (Hill)",
    "auto": "Automatic", "msaa-2": "2 samples", "msaa-4": "4 samples", "msaa-8": "8 samples",
    "off": "Off", "fast": "Fast", "mis": "Both (MIS)", "bsdf": "BSDF sampling only",
    "lights": "Light sampling only", "environment": "Environment only", "screen": "Screen space", "traced": "Traced",
    "baked": "Baked",
}
_MODES = ((("pbr",), ("phong",), ("path",)), (("phong", "pbr"), ("pbr", "path")))
_TONEMAPS = ("neutral", "agx", "aces", "none")
_FIRST_COLOR = (0.18, 0.18, 0.18)
_WARNING = imgui.ImVec4(0.95, 0.75, 0.35, 1.0)


@dataclass
class Readings:
    """Information for the panel: the device, milliseconds of the last frames, and what the plan has left out."""

    device: str = ""
    frame_ms: deque[float] = field(default_factory=lambda: deque(maxlen=120))
    left_out: Sequence[str] = ()


class Panel:
    """`open_file` opens a path that the user has entered: a model or an environment."""

    def __init__(self, state: ViewState, readings: Readings, open_file: Callable[[str], None]) -> None:
        self._state, self._readings, self._open_file = state, readings, open_file
        self._path = ""
        self._scale = 1.0

    def draw(self, scale: float) -> float:
        """Draw the panel. Returns its width in window coordinates."""
        self._scale = scale
        width, height = imgui.get_io().display_size
        panel_width = min(WIDTH * scale, width)
        imgui.set_next_window_pos(imgui.ImVec2(width - panel_width, 0))
        imgui.set_next_window_size(imgui.ImVec2(panel_width, height))
        flags = imgui.WindowFlags_
        imgui.begin("##panel", None, flags.no_decoration & ~flags.no_scrollbar | flags.no_move | flags.no_nav
                    | flags.no_saved_settings)
        for name, is_open, section in (
            ("Warnings", True, self._warnings), ("Shading", True, self._shading),
            ("Path tracing", True, self._path_tracing), ("Environment", True, self._environment),
            ("Lights", False, self._lights),
            ("Picture", True, self._picture), ("Model", False, self._model),
            ("Left out", False, self._left_out), ("Frame time", True, self._frame_time),
        ):
            if (name == "Warnings" and not self._state.scene.all_warnings) or (
                    name == "Path tracing" and not self._state.shows("path")):
                continue
            imgui.push_id(name)
            if imgui.collapsing_header(name, imgui.TreeNodeFlags_.default_open if is_open else 0):
                section()
                imgui.spacing()
            imgui.pop_id()
        imgui.end()
        return panel_width

    def _warnings(self) -> None:
        for line in self._state.scene.all_warnings:
            _wrapped(line, _WARNING)

    def _shading(self) -> None:
        state = self._state
        for row in _MODES:
            for modes in row:
                if imgui.radio_button(" | ".join(MODE_NAMES[m] for m in modes), state.modes == modes) and (
                        state.modes != modes):
                    state.show_split(*modes) if len(modes) > 1 else state.show_mode(*modes, state.settings.lobes)
                imgui.same_line(spacing=14 * self._scale)
            imgui.new_line()
        self._choice("Show", "lobes")
        if imgui.checkbox("White furnace", state.before_furnace is not None)[0]:
            state.toggle_furnace()
        self._choice("Distribution D", "ndf")
        self._choice("Masking G", "masking")
        self._choice("Fresnel F", "fresnel")
        self._switch("Multiple scattering", "multiscatter")
        self._choice("Environment shadows", "environment_shadows")
        self._choice("Ambient occlusion", "ambient_occlusion")
        self._choice("Indirect light", "indirect")
        self._choice("Reflections", "reflections")
        self._choice("Refraction", "refraction")
        self._switch("Specular antialiasing", "specular_aa")
        self._choice("Phong highlight", "phong")

    def _path_tracing(self) -> None:
        state = self._state
        self._combo("Denoising", "denoise", ("off", "fast"))
        self._choice("Sampling", "sampling")
        self._row("Bounces")
        changed, bounces = imgui.slider_int("##bounces", state.settings.bounces, 1, 64, "%d",
                                            imgui.SliderFlags_.logarithmic | imgui.SliderFlags_.always_clamp)
        if changed:
            state.settings = replace(state.settings, bounces=bounces)
        if imgui.checkbox("Paused", state.paused)[0]:
            state.toggle_pause()

    def _environment(self) -> None:
        state = self._state
        environment = state.scene.environment
        names = [*PRESETS, "none"]
        current = "none" if environment is None else environment.name
        if current not in names:
            names.append(current)
        self._row("Environment")
        if imgui.begin_combo("##environment", current):
            for name in names:
                if imgui.selectable(name, name == current)[0] and name != current:
                    state.relight(load_environment(name))
            imgui.end_combo()
        self._row("File")
        entered, self._path = imgui.input_text_with_hint("##file", "HDR or EXR, or drop it", self._path,
                                                         imgui.InputTextFlags_.enter_returns_true)
        if entered and self._path.strip():
            self._open_file(self._path.strip())
        if environment is None:
            return
        self._row("Rotation")
        turned, rotation = imgui.slider_angle("##rotation", environment.rotation, -180, 180, "%.0f°")
        self._row("Intensity")
        scaled, intensity = _logarithmic("##intensity", environment.intensity, 0.01, 100.0)
        if turned or scaled:
            changed = replace(environment, rotation=rotation, intensity=intensity)
            state.scene = state.scene.relit(environment=changed)

    def _lights(self) -> None:
        lights = list(self._state.scene.lights)
        changed = False
        for k, light in enumerate(self._state.scene.lights):
            imgui.push_id(k)
            imgui.align_text_to_frame_padding()
            imgui.text(f"{k + 1}  {light.kind.capitalize()}  {light.name.lstrip('-')}")
            imgui.same_line(imgui.get_content_region_avail().x - 62 * self._scale)
            if imgui.button("Remove", imgui.ImVec2(-1, 0)):
                lights[k], changed = None, True
            else:
                edited = self._light(light)
                changed, lights[k] = changed or edited != light, edited
            imgui.pop_id()
        if imgui.button("Add a directional light", imgui.ImVec2(-1, 0)):
            lights.append(Light.from_angles(math.radians(40), math.radians(45), math.pi))
            changed = True
        if changed:
            self._state.set_lights(tuple(light for light in lights if light is not None))

    def _light(self, light: Light) -> Light:
        if light.kind == "directional":
            x, y, z = (-d for d in light.direction)
            azimuth, elevation = math.atan2(x, z), math.atan2(y, math.hypot(x, z))
            self._row("Azimuth")
            turned, azimuth = imgui.slider_angle("##azimuth", azimuth, -180, 180, "%.0f°")
            self._row("Elevation")
            raised, elevation = imgui.slider_angle("##elevation", elevation, -89, 89, "%.0f°")
            if turned or raised:
                light = replace(light, direction=Light.from_angles(azimuth, elevation, 1.0).direction)
        self._row("Lux" if light.kind == "directional" else "Candela")
        changed, intensity = _logarithmic("##intensity", light.intensity, 0.001, 1e5)
        if changed:
            light = replace(light, intensity=intensity)
        self._row("Colour")
        changed, color = _color("##color", light.color)
        return replace(light, color=color) if changed else light

    def _picture(self) -> None:
        state = self._state
        settings = state.settings
        self._row("Exposure")
        exposed, exposure = imgui.slider_float("##exposure", settings.exposure, -8.0, 8.0, "%+.2f EV")
        if exposed:
            state.settings = replace(settings, exposure=exposure)
        self._combo("Tone map", "tonemap", _TONEMAPS)
        self._row("Background")
        kinds = ("env", "none", "color")
        kind = settings.background if isinstance(settings.background, str) else "color"
        chosen, index = imgui.combo("##background", kinds.index(kind), ["Environment", "None", "Colour"])
        if chosen:
            background = _FIRST_COLOR if kinds[index] == "color" else kinds[index]
            state.settings = replace(state.settings, background=background)
        if kind == "color":
            self._row("")
            changed, color = _color("##background color", settings.background)
            if changed:
                state.settings = replace(state.settings, background=color)
        self._choice("Antialiasing", "antialias")
        self._switch("Shadows", "shadows")

    def _model(self) -> None:
        for name, value in scene_facts(self._state.scene):
            self._row(name)
            _wrapped(value)

    def _left_out(self) -> None:
        for line in self._readings.left_out:
            _wrapped(line[:1].upper() + line[1:], imgui.get_style_color_vec4(imgui.Col_.text_disabled))

    def _frame_time(self) -> None:
        times = np.array(self._readings.frame_ms, np.float32)
        if len(times):
            text = f"median {np.median(times):.1f} ms, last {times[-1]:.1f} ms"
            size = imgui.ImVec2(-1, 46 * self._scale)
            imgui.plot_lines("##ms", times, 0, None, 0.0, float(times.max()) * 1.2, size)
            imgui.text(text)
        _wrapped(self._readings.device, imgui.get_style_color_vec4(imgui.Col_.text_disabled))

    def _row(self, label: str) -> None:
        """Draw a label, and put ImGui's cursor where its widget goes."""
        imgui.align_text_to_frame_padding()
        imgui.text(label)
        imgui.same_line(imgui.get_style().window_padding.x + _LABEL_WIDTH * self._scale)
        imgui.set_next_item_width(-1)

    def _choice(self, label: str, name: str) -> None:
        """A row for a setting with choices, if a mode that is shown uses it."""
        if name not in ignored(*self._state.modes):
            self._combo(label, name, _choices()[name])

    def _combo(self, label: str, name: str, values: Sequence[str]) -> None:
        self._row(label)
        current = values.index(getattr(self._state.settings, name))
        changed, index = imgui.combo(f"##{name}", current, [_LABELS.get(value, value) for value in values])
        if changed:
            self._state.settings = replace(self._state.settings, **{name: values[index]})

    def _switch(self, label: str, name: str) -> None:
        """A check box for a setting that is on or off, if a mode that is shown uses it."""
        if name in ignored(*self._state.modes):
            return
        changed, on = imgui.checkbox(label, getattr(self._state.settings, name) == "on")
        if changed:
            self._state.settings = replace(self._state.settings, **{name: "on" if on else "off"})


_choices = cache(setting_choices)


def _wrapped(text: str, color: imgui.ImVec4 | None = None) -> None:
    if color is not None:
        imgui.push_style_color(imgui.Col_.text, color)
    imgui.push_text_wrap_pos(0.0)
    imgui.text_unformatted(text)
    imgui.pop_text_wrap_pos()
    if color is not None:
        imgui.pop_style_color()


def _logarithmic(label: str, value: float, low: float, high: float) -> tuple[bool, float]:
    flags = imgui.SliderFlags_.logarithmic | imgui.SliderFlags_.no_round_to_format
    return imgui.slider_float(label, value, low, high, "%.3g", flags)


def _color(label: str, linear) -> tuple[bool, tuple[float, float, float]]:
    """A colour picker, which shows sRGB, for a value in linear Rec. 709."""
    shown = [float(c) for c in linear_to_srgb(np.clip(linear, 0, 1))]
    changed, shown = imgui.color_edit3(label, shown)
    return changed, tuple(float(c) for c in srgb_to_linear(np.array(shown))) if changed else linear
