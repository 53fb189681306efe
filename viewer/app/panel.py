"""The panel at the right of the window: all settings, and information about model and frame."""

from __future__ import annotations

import os
from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from imgui_bundle import imgui

from ..interact.playback import SPEEDS
from ..interact.scene_facts import scene_facts
from ..interact.state import ViewState
from ..plan.legend import VIEW_NAMES
from ..quality import QUALITIES
from ..scene.environment_files import load_environment
from ..scene.environment_presets import PRESETS
from .light_rows import edited_lights
from .overlay import MODE_NAMES
from .setting_rows import SettingRows
from .tips import tip_of
from .widgets import color_edit, combo, logarithmic, tooltip, wrapped

WIDTH = 344.0
"""In window coordinates, before the desktop's scale."""
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


@dataclass(frozen=True)
class Section:
    """A part of the panel below a title; `is_open` at first, and only there where `is_there` says so."""

    title: str
    draw: Callable[[], None]
    is_open: bool = True
    is_there: Callable[[], bool] = lambda: True


class Panel:
    """`open_file` opens a path that the user has entered: a model or an environment. `copy` copies the picture as a
    command line."""

    def __init__(self, state: ViewState, readings: Readings, open_file: Callable[[str], None],
                 copy: Callable[[], None]) -> None:
        self._state, self._readings, self._open_file, self._copy = state, readings, open_file, copy
        self._path = ""
        self._rows = SettingRows(state)
        self._sections = (
            Section("Warnings", self._warnings, is_there=lambda: bool(state.scene.all_warnings)),
            Section("Variant", self._variant, is_there=lambda: bool(state.scene.variants)),
            Section("Shading", self._shading),
            Section("Path tracing", self._path_tracing, is_there=lambda: state.shows("path")),
            Section("Animation", self._animation, is_there=lambda: bool(state.scene.animations)),
            Section("Environment", self._environment, is_there=lambda: state.before_furnace is None),
            Section("Lights", self._lights, is_open=False, is_there=lambda: state.before_furnace is None),
            Section("Picture", self._picture),
            Section("Model", self._model, is_open=False),
            Section("Left out", self._left_out, is_open=False),
            Section("Frame time", self._frame_time),
        )

    def width(self, window_width: float, scale: float) -> float:
        """The width of the panel in window coordinates, and 0 if it is closed."""
        return min(WIDTH * scale, window_width) if self._state.panel else 0.0

    def draw(self, scale: float) -> None:
        """Draw the panel at the right of the window."""
        self._rows.begin(scale)
        width, height = imgui.get_io().display_size
        panel_width = self.width(width, scale)
        imgui.set_next_window_pos(imgui.ImVec2(width - panel_width, 0))
        imgui.set_next_window_size(imgui.ImVec2(panel_width, height))
        flags = imgui.WindowFlags_
        imgui.begin("##panel", None, flags.no_decoration & ~flags.no_scrollbar | flags.no_move | flags.no_nav
                    | flags.no_saved_settings)
        for section in self._sections:
            if section.is_there():
                imgui.push_id(section.title)
                if imgui.collapsing_header(section.title, imgui.TreeNodeFlags_.default_open if section.is_open else 0):
                    section.draw()
                    imgui.spacing()
                imgui.pop_id()
        imgui.end()

    def _warnings(self) -> None:
        for line in self._state.scene.all_warnings:
            wrapped(line, _WARNING)

    def _variant(self) -> None:
        scene = self._state.scene
        names = [variant.name for variant in scene.variants]
        self._rows.row("Materials")
        index = combo("variant", names.index(scene.variant), ["The file's own", *names[1:]])
        if index is not None:
            self._state.choose_variant(names[index])

    def _shading(self) -> None:
        state = self._state
        for line in _MODES:
            for modes in line:
                label = " | ".join(MODE_NAMES[m] for m in modes)
                is_chosen = imgui.radio_button(label, state.modes == modes)
                tooltip(tip_of(label))
                if is_chosen and state.modes != modes:
                    state.show_split(*modes) if len(modes) > 1 else state.show_mode(*modes, state.settings.lobes)
                imgui.same_line(spacing=14 * self._rows.scale)
            imgui.new_line()
        self._values()
        self._quality()
        self._rows.choice("Light shown", "lobes")
        if _checked("White furnace", state.before_furnace is not None):
            state.toggle_furnace()
        if state.has_error:
            if _checked("Tell the error, at rest", state.tells_error):
                state.toggle_error()
            if state.tells_error and _checked("Show where", state.shows_error):
                state.toggle_error(shows=True)
        self._rows.choice("Distribution D", "ndf")
        self._rows.choice("Masking G", "masking")
        self._rows.choice("Fresnel F", "fresnel")
        self._rows.switch("Multiple scattering", "multiscatter")
        self._rows.choice("Sheen", "sheen")
        self._rows.choice("Environment shadows", "environment_shadows")
        self._rows.choice("Ambient occlusion", "ambient_occlusion")
        self._rows.choice("Indirect light", "indirect")
        self._rows.choice("Reflections", "reflections")
        self._rows.choice("Refraction", "refraction")
        self._rows.choice("Caustics of lamps", "caustics")
        self._rows.choice("Light inside solids", "subsurface")
        self._rows.choice("Light between hairs", "hair_scattering")
        self._rows.choice("Curves as yarn", "yarn")
        self._rows.choice("Scattering in media", "media_scattering")
        self._rows.choice("Rays in media", "media_rays")
        self._rows.choice("Steps of a ray", "media_steps")
        self._rows.switch("Specular antialiasing", "specular_aa")
        self._rows.choice("Phong highlight", "phong")

    def _values(self) -> None:
        shows = list(VIEW_NAMES)
        self._rows.row("Show")
        index = combo("show", shows.index(self._state.settings.show), list(VIEW_NAMES.values()))
        if index is not None:
            self._state.show_values(shows[index])

    def _quality(self) -> None:
        if not self._state.shows("pbr"):
            return
        self._rows.row("Quality at rest")
        index = combo("quality", QUALITIES.index(self._state.quality.name), [name.capitalize() for name in QUALITIES])
        if index is not None:
            self._state.choose_quality(QUALITIES[index])

    def _path_tracing(self) -> None:
        state = self._state
        self._rows.combo("Denoising", "denoise", ("off", "fast", "raster"))
        self._rows.choice("Sampling", "sampling")
        self._rows.row("Bounces", "bounces")
        changed, bounces = imgui.slider_int("##bounces", state.settings.bounces, 1, 64, "%d",
                                            imgui.SliderFlags_.logarithmic | imgui.SliderFlags_.always_clamp)
        if changed:
            state.settings = replace(state.settings, bounces=bounces)
        if _checked("Paused", state.paused):
            state.toggle_pause()

    def _animation(self) -> None:
        state, playback = self._state, self._state.playback
        self._rows.row("Animation")
        names = ["At rest", *(animation.name for animation in state.scene.animations)]
        index = combo("animation", 0 if playback.animation is None else playback.animation + 1, names)
        if index is not None:
            state.show_animation(index - 1 if index else None)
        if imgui.button("Pause" if playback.is_playing else "Play", imgui.ImVec2(-1, 0)):
            state.toggle_play()
        if playback.animation is None:
            return
        self._rows.row("Time")
        duration = playback.duration(state.scene)
        flags = imgui.SliderFlags_.always_clamp
        moved, moment = imgui.slider_float("##time", playback.time, 0.0, duration, f"%.2f of {duration:.2f} s", flags)
        if moved:
            state.seek(moment)
        self._rows.row("Speed")
        changed, speed = logarithmic("##speed", playback.speed, *SPEEDS)
        if changed:
            playback.speed = min(max(speed, SPEEDS[0]), SPEEDS[1])

    def _environment(self) -> None:
        state = self._state
        environment = state.scene.environment
        names = [*PRESETS, "none"]
        current = "none" if environment is None else environment.name
        if current not in names:
            names.append(current)
        self._rows.row("Environment")
        index = combo("environment", names.index(current), names)
        if index is not None and names[index] != current:
            state.relight(load_environment(names[index]))
        self._rows.row("File")
        entered, self._path = imgui.input_text_with_hint("##file", "path, or drop a file", self._path,
                                                         imgui.InputTextFlags_.enter_returns_true)
        if entered and self._path.strip():
            self._open_file(os.path.expanduser(self._path.strip()))
        if environment is None:
            return
        self._rows.row("Rotation")
        turned, rotation = imgui.slider_angle("##rotation", environment.rotation, -180, 180, "%.0f°")
        self._rows.row("Intensity")
        scaled, intensity = logarithmic("##intensity", environment.intensity, 0.01, 100.0)
        if turned or scaled:
            changed = replace(environment, rotation=rotation, intensity=intensity)
            state.scene = state.scene.relit(environment=changed)

    def _lights(self) -> None:
        lights = edited_lights(self._state.scene.lights, self._rows)
        if lights is not None:
            self._state.set_lights(lights)

    def _picture(self) -> None:
        state = self._state
        settings = state.settings
        self._rows.row("Exposure")
        exposed, exposure = imgui.slider_float("##exposure", settings.exposure, -8.0, 8.0, "%+.2f EV")
        if exposed:
            state.settings = replace(settings, exposure=exposure)
        self._rows.combo("Tone map", "tonemap", _TONEMAPS)
        self._rows.row("Background")
        kinds = ("env", "none", "color")
        kind = settings.background if isinstance(settings.background, str) else "color"
        index = combo("background", kinds.index(kind), ["Environment", "None", "Colour"])
        if index is not None:
            background = _FIRST_COLOR if kinds[index] == "color" else kinds[index]
            state.settings = replace(state.settings, background=background)
        if kind == "color":
            self._rows.row("")
            changed, color = color_edit("##background color", settings.background)
            if changed:
                state.settings = replace(state.settings, background=color)
        if kind == "env" and state.scene.environment is not None:
            self._rows.row("Background blur", "background_blur")
            changed, blur = imgui.slider_float("##background blur", settings.background_blur, 0.0, 20.0, "%.1f°")
            if changed:
                state.settings = replace(state.settings, background_blur=blur)
        self._rows.choice("Antialiasing", "antialias")
        self._rows.switch("Shadows", "shadows")
        self._rows.switch("Grid and axes", "grid")
        if imgui.button("Copy as command line", imgui.ImVec2(-1, 0)):
            self._copy()
        tooltip(tip_of("Copy as command line"))

    def _model(self) -> None:
        for name, value in scene_facts(self._state.scene):
            self._rows.row(name)
            wrapped(value)

    def _left_out(self) -> None:
        for line in self._readings.left_out:
            wrapped(line[:1].upper() + line[1:], imgui.get_style_color_vec4(imgui.Col_.text_disabled))

    def _frame_time(self) -> None:
        times = np.array(self._readings.frame_ms, np.float32)
        if len(times):
            text = f"median {np.median(times):.1f} ms, last {times[-1]:.1f} ms"
            size = imgui.ImVec2(-1, 46 * self._rows.scale)
            imgui.plot_lines("##ms", times, 0, None, 0.0, float(times.max()) * 1.2, size)
            imgui.text(text)
        wrapped(self._readings.device, imgui.get_style_color_vec4(imgui.Col_.text_disabled))


def _checked(label: str, on: bool) -> bool:
    """Draw a check box with its tooltip. Returns whether it was clicked."""
    clicked = imgui.checkbox(label, on)[0]
    tooltip(tip_of(label))
    return clicked
