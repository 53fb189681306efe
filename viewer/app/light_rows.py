"""The rows of the panel for the lights of a scene."""

from __future__ import annotations

import math
from dataclasses import replace

from imgui_bundle import imgui

from ..interact.command_line import angles_of
from ..scene.light import Light
from .setting_rows import SettingRows
from .widgets import color_edit, logarithmic


def edited_lights(given: tuple[Light, ...], rows: SettingRows) -> tuple[Light, ...] | None:
    """Draw the rows of all lights. Returns the lights as they are changed in this frame; None if none is."""
    lights: list[Light | None] = list(given)
    changed = False
    for k, light in enumerate(given):
        imgui.push_id(k)
        imgui.align_text_to_frame_padding()
        imgui.text(f"{k + 1}  {light.kind.capitalize()}  {light.name.lstrip('-')}")
        imgui.same_line(imgui.get_content_region_avail().x - 62 * rows.scale)
        if imgui.button("Remove", imgui.ImVec2(-1, 0)):
            lights[k], changed = None, True
        else:
            edited = _edited_light(light, rows)
            changed, lights[k] = changed or edited != light, edited
        imgui.pop_id()
    if imgui.button("Add a directional light", imgui.ImVec2(-1, 0)):
        lights.append(Light.from_angles(math.radians(40), math.radians(45), math.pi))
        changed = True
    return tuple(light for light in lights if light is not None) if changed else None


def _edited_light(light: Light, rows: SettingRows) -> Light:
    if light.kind == "directional":
        azimuth, elevation = angles_of(light)
        rows.row("Azimuth")
        turned, azimuth = imgui.slider_angle("##azimuth", azimuth, -180, 180, "%.0f°")
        rows.row("Elevation")
        raised, elevation = imgui.slider_angle("##elevation", elevation, -89, 89, "%.0f°")
        if turned or raised:
            light = replace(light, direction=Light.from_angles(azimuth, elevation, 1.0).direction)
    rows.row("Lux" if light.kind == "directional" else "Candela")
    changed, intensity = logarithmic("##intensity", light.intensity, 0.001, 1e5)
    if changed:
        light = replace(light, intensity=intensity)
    rows.row("Colour")
    changed, color = color_edit("##color", light.color)
    return replace(light, color=color) if changed else light
