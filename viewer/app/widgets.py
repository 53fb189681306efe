"""The rows of the panel: a label at the left, and a widget that fills what is left of the line."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from imgui_bundle import imgui

from ..scene.color import linear_to_srgb, srgb_to_linear

LABEL_WIDTH = 138.0
"""In window coordinates, before the desktop's scale. The longest label of the panel fits."""

RGB = tuple[float, float, float]


def row(label: str, scale: float, tip: str = "") -> None:
    """Draw a label, with `tip` where the mouse is over it, and put ImGui's cursor where its widget goes."""
    imgui.align_text_to_frame_padding()
    imgui.text(label)
    tooltip(tip)
    imgui.same_line(imgui.get_style().window_padding.x + LABEL_WIDTH * scale)
    imgui.set_next_item_width(-1)


def tooltip(text: str) -> None:
    """Show `text` beside the mouse if it is over what was drawn last. There is no delay, as nothing is drawn again
    while the mouse rests."""
    if text and imgui.is_item_hovered():
        imgui.begin_tooltip()
        imgui.push_text_wrap_pos(imgui.get_font_size() * 24)
        imgui.text_unformatted(text)
        imgui.pop_text_wrap_pos()
        imgui.end_tooltip()


def combo(name: str, current: int, texts: Sequence[str]) -> int | None:
    """Draw a list of `texts` that drops down. Returns the number of the text that was chosen in this frame."""
    changed, index = imgui.combo(f"##{name}", current, list(texts))
    return index if changed else None


def logarithmic(label: str, value: float, low: float, high: float) -> tuple[bool, float]:
    """Draw a slider over orders of magnitude. Returns whether it was moved, and its value."""
    flags = imgui.SliderFlags_.logarithmic | imgui.SliderFlags_.no_round_to_format
    return imgui.slider_float(label, value, low, high, "%.3g", flags)


def color_edit(label: str, linear: RGB) -> tuple[bool, RGB]:
    """A colour picker, which shows sRGB, for a value in linear Rec. 709."""
    shown = [float(c) for c in linear_to_srgb(np.clip(linear, 0, 1))]
    changed, shown = imgui.color_edit3(label, shown)
    return changed, tuple(float(c) for c in srgb_to_linear(np.array(shown))) if changed else linear


def wrapped(text: str, shade: imgui.ImVec4 | None = None) -> None:
    """Draw text that breaks at the panel's edge, in the colour `shade`."""
    if shade is not None:
        imgui.push_style_color(imgui.Col_.text, shade)
    imgui.push_text_wrap_pos(0.0)
    imgui.text_unformatted(text)
    imgui.pop_text_wrap_pos()
    if shade is not None:
        imgui.pop_style_color()
