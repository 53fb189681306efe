"""Overlays on the picture: the split line, the progress of path tracing, a message, the help."""

from __future__ import annotations

from collections.abc import Sequence

from imgui_bundle import imgui

from ..interact.keys import help_groups
from ..interact.state import ViewState
from ..plan.legend import overdraw_colors

MODE_NAMES = {"pbr": "PBR", "phong": "Phong", "path": "Path-traced"}
_WHITE, _SHADOW = 0xE6FFFFFF, 0xB4000000  # ABGR
_INFO, _ERROR = 0xE61E1E1E, 0xF0202890
_HINT = imgui.ImVec4(0.62, 0.74, 0.90, 1.0)


def draw_split(position: float, sides: Sequence[str], scale: float, width: float) -> None:
    """Draw the split line at `position` (a fraction of the picture's `width`), its handle, and the names of the
    modes."""
    height = imgui.get_io().display_size.y
    draw, x = imgui.get_background_draw_list(), round(position * width) + 0.5
    draw.add_line((x, 0), (x, height), _SHADOW, 3 * scale)
    draw.add_line((x, 0), (x, height), _WHITE, scale)
    draw.add_circle_filled((x, height / 2), 7 * scale, _WHITE)
    draw.add_circle((x, height / 2), 7 * scale, _SHADOW, 0, scale)
    gap, y = 12 * scale, 10 * scale
    left, right = (MODE_NAMES[mode] for mode in sides)
    _label(draw, x - gap - imgui.calc_text_size(left).x, y, left, _SHADOW, scale)
    _label(draw, x + gap, y, right, _SHADOW, scale)


def draw_status(text: str, scale: float, width: float) -> None:
    """Draw a line at the top left, below the names of a split's modes; it is wrapped where the picture, `width` pixels
    wide, is narrower."""
    x = 14 * scale
    _label(imgui.get_background_draw_list(), x, 38 * scale, text, _SHADOW, scale, wrap=max(width - 2 * x, 60.0))


def draw_counts(scale: float) -> None:
    """Draw the colours of the counts of overdraw, each with its number, below the status."""
    draw, side, x, y = imgui.get_background_draw_list(), 22 * scale, 14 * scale, 64 * scale
    colors = overdraw_colors()
    for k, color in enumerate(colors):
        text = f"{k + 1}" + "+" * (k + 1 == len(colors))
        red, green, blue = map(int, color)
        size = imgui.calc_text_size(text)
        draw.add_rect_filled((x, y), (x + side, y + side), 0xFF000000 | blue << 16 | green << 8 | red)
        draw.add_text((x + (side - size.x) / 2, y + (side - size.y) / 2), _WHITE if k < 4 else 0xFF000000, text)
        x += side


def draw_message(state: ViewState, scale: float, width: float) -> None:
    """Draw the message at the bottom left, wrapped at `width`."""
    margin, padding = 14 * scale, imgui.get_style().window_padding
    wrap = max(width - 2 * (margin + padding.x), 60.0)
    size = imgui.calc_text_size(state.message, wrap_width=wrap)
    size = (size.x + 2 * padding.x + 1, size.y + 2 * padding.y)
    imgui.set_next_window_pos((margin, imgui.get_io().display_size.y - margin - size[1]))
    imgui.set_next_window_size(size)
    imgui.push_style_color(imgui.Col_.window_bg, _ERROR if state.is_error else _INFO)
    imgui.push_style_var(imgui.StyleVar_.window_rounding, 4 * scale)
    imgui.begin("##message", None, _STILL | imgui.WindowFlags_.no_inputs)
    imgui.push_text_wrap_pos(padding.x + wrap)
    imgui.text_unformatted(state.message)
    imgui.pop_text_wrap_pos()
    imgui.end()
    imgui.pop_style_var()
    imgui.pop_style_color()


def draw_help(state: ViewState, scale: float) -> None:
    """Draw the list of all keys and gestures over all else, in two columns if the window is wide enough."""
    width, height = imgui.get_io().display_size
    imgui.set_next_window_focus()  # in front of the panel
    imgui.set_next_window_pos((width / 2, height / 2), 0, (0.5, 0.5))
    imgui.set_next_window_size_constraints((0, 0), (width, height))
    imgui.push_style_var(imgui.StyleVar_.window_rounding, 6 * scale)
    imgui.set_next_window_bg_alpha(0.97)
    imgui.push_style_var(imgui.StyleVar_.window_padding, (22 * scale, 18 * scale))
    imgui.begin("##help", None, _STILL & ~imgui.WindowFlags_.no_scrollbar | imgui.WindowFlags_.always_auto_resize)
    groups = help_groups()
    imgui.push_text_wrap_pos(width - 22 * scale - imgui.get_style().scrollbar_size)
    for column in (groups[:2], groups[2:]) if width > 1010 * scale else (groups,):
        if column is not groups and column[0] is not groups[0]:
            imgui.same_line(spacing=36 * scale)
        imgui.begin_group()
        for title, lines in column:
            imgui.text_colored(_HINT, title)
            _table(title, lines)
            imgui.dummy((0, 6 * scale))
        imgui.end_group()
    imgui.pop_text_wrap_pos()
    imgui.end()
    imgui.pop_style_var(2)
    if imgui.is_mouse_clicked(0):
        state.help = False


_STILL = (imgui.WindowFlags_.no_decoration | imgui.WindowFlags_.no_move | imgui.WindowFlags_.no_nav
          | imgui.WindowFlags_.no_saved_settings | imgui.WindowFlags_.no_focus_on_appearing)


def _table(title: str, lines: list[tuple[str, str]]) -> None:
    flags = imgui.TableFlags_.sizing_fixed_fit | imgui.TableFlags_.no_host_extend_x
    if imgui.begin_table(title, 2, flags):
        for keys, text in lines:
            imgui.table_next_column()
            imgui.text_disabled(keys)
            imgui.table_next_column()
            imgui.text(text)
        imgui.end_table()


def _label(draw: imgui.ImDrawList, x: float, y: float, text: str, shade: int, scale: float, wrap: float = -1.0) -> None:
    """Draw `text` over a dark rectangle, in lines of at most `wrap` pixels; in one if `wrap` is below 0."""
    size = imgui.calc_text_size(text, wrap_width=wrap)
    pad = 5 * scale
    draw.add_rect_filled((x - pad, y - pad / 2), (x + size.x + pad, y + size.y + pad / 2), shade, 3 * scale)
    draw.add_text(imgui.get_font(), imgui.get_font_size(), (x, y), _WHITE, text, wrap_width=max(wrap, 0.0))
