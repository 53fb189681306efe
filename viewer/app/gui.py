"""Dear ImGui in the window: its style, its input, and drawing its triangles with moderngl."""

from __future__ import annotations

import ctypes
from typing import Any

import glfw
import moderngl
import numpy as np
from imgui_bundle import imgui

from ..gpu.context import Context
from ..gpu.program import compile_program
from ..image.fonts import roboto_file

FONT_SIZE = 15.0
NOWHERE = -1e9, -1e9
"""Where a mouse is that has left the window."""
_UNIT = 0
_KEYS = {  # the keys that text fields need
    glfw.KEY_TAB: imgui.Key.tab, glfw.KEY_BACKSPACE: imgui.Key.backspace, glfw.KEY_ENTER: imgui.Key.enter,
    glfw.KEY_KP_ENTER: imgui.Key.keypad_enter, glfw.KEY_ESCAPE: imgui.Key.escape, glfw.KEY_DELETE: imgui.Key.delete,
    glfw.KEY_LEFT: imgui.Key.left_arrow, glfw.KEY_RIGHT: imgui.Key.right_arrow, glfw.KEY_UP: imgui.Key.up_arrow,
    glfw.KEY_DOWN: imgui.Key.down_arrow, glfw.KEY_HOME: imgui.Key.home, glfw.KEY_END: imgui.Key.end,
    glfw.KEY_A: imgui.Key.a, glfw.KEY_C: imgui.Key.c, glfw.KEY_V: imgui.Key.v, glfw.KEY_X: imgui.Key.x,
    glfw.KEY_Y: imgui.Key.y, glfw.KEY_Z: imgui.Key.z,
}
_MODIFIERS = (
    (glfw.MOD_CONTROL, imgui.Key.mod_ctrl), (glfw.MOD_SHIFT, imgui.Key.mod_shift),
    (glfw.MOD_ALT, imgui.Key.mod_alt), (glfw.MOD_SUPER, imgui.Key.mod_super),
)


class Gui:
    """The ImGui context of one window. Between `begin` and `draw` the panel and the overlays submit their widgets."""

    def __init__(self, context: Context, window: Any) -> None:
        self._gl, self._window = context.gl, window
        self._imgui = imgui.create_context()
        self.io = imgui.get_io()
        self.io.set_ini_filename("")  # ImGui shall not write a file into the current folder
        self.io.set_log_filename("")
        self.io.backend_flags |= imgui.BackendFlags_.renderer_has_textures
        self.io.fonts.add_font_from_file_ttf(str(roboto_file()), FONT_SIZE)
        platform = imgui.get_platform_io()
        platform.platform_get_clipboard_text_fn = lambda _: _clipboard(window)
        platform.platform_set_clipboard_text_fn = lambda _, text: glfw.set_clipboard_string(window, text)
        self._program = compile_program(context, vertex="app/gui.vert", fragment="app/gui.frag")
        self._vertices = self._gl.buffer(reserve=imgui.VERTEX_SIZE, dynamic=True)
        self._indices = self._gl.buffer(reserve=imgui.INDEX_SIZE, dynamic=True)
        self._array = self._gl.vertex_array(
            self._program, [(self._vertices, "2f 2f 4f1", "a_position", "a_uv", "a_color")], self._indices,
            index_element_size=imgui.INDEX_SIZE,
        )
        self._textures: dict[int, moderngl.Texture] = {}
        self._time = glfw.get_time()
        self._mouse = imgui.ImVec2(*NOWHERE)
        _set_style(imgui.get_style())
        self.scale = 1.0
        self._fit_scale()

    def begin(self) -> None:
        """Start a frame of ImGui."""
        imgui.set_current_context(self._imgui)
        width, height = glfw.get_window_size(self._window)
        pixels = glfw.get_framebuffer_size(self._window)
        self.io.display_size = imgui.ImVec2(width, height)
        self.io.display_framebuffer_scale = imgui.ImVec2(pixels[0] / max(width, 1), pixels[1] / max(height, 1))
        now = glfw.get_time()
        self.io.delta_time, self._time = max(now - self._time, 1e-4), now
        self._fit_scale()
        imgui.new_frame()

    def draw(self, target: moderngl.Framebuffer) -> None:
        """Finish the frame and draw it over the content of `target`."""
        imgui.render()
        data = imgui.get_draw_data()
        for texture in imgui.get_platform_io().textures:
            if texture.status != imgui.ImTextureStatus.ok:
                self._update(texture)
        target.use()
        gl = self._gl
        gl.enable_only(moderngl.BLEND)
        gl.blend_func = moderngl.SRC_ALPHA, moderngl.ONE_MINUS_SRC_ALPHA, moderngl.ONE, moderngl.ONE_MINUS_SRC_ALPHA
        self._program["u_size"] = tuple(self.io.display_size)
        self._program["u_texture"] = _UNIT
        scale_x, scale_y = self.io.display_framebuffer_scale
        height = self.io.display_size.y * scale_y  # not that of `target`, which a screen has from when it was made
        for commands in data.cmd_lists:
            self._upload(commands)
            for command in commands.cmd_buffer:
                left, top, right, bottom = command.clip_rect
                if right <= left or bottom <= top:
                    continue
                gl.scissor = (int(left * scale_x), int(height - bottom * scale_y),
                              int((right - left) * scale_x), int((bottom - top) * scale_y))
                self._textures[command.tex_ref.get_tex_id()].use(_UNIT)
                self._array.render(vertices=command.elem_count, first=command.idx_offset)
        gl.scissor = None

    def on_key(self, key: int, action: int, modifiers: int) -> None:
        for flag, name in _MODIFIERS:
            self.io.add_key_event(name, bool(modifiers & flag))
        if key in _KEYS:
            self.io.add_key_event(_KEYS[key], action != glfw.RELEASE)

    def on_character(self, codepoint: int) -> None:
        self.io.add_input_character(codepoint)

    def close_popups(self) -> bool:
        """Close the lists and colour pickers that are open. Returns whether there were any."""
        imgui.set_current_context(self._imgui)
        flags = imgui.PopupFlags_
        is_open = imgui.is_popup_open("", flags.any_popup_id | flags.any_popup_level)
        if is_open:
            imgui.internal.close_popup_to_level(0, True)
        return is_open

    def on_move(self, x: float, y: float) -> None:
        self._mouse = imgui.ImVec2(x, y)
        self.io.add_mouse_pos_event(x, y)

    @property
    def wants_mouse(self) -> bool:
        """Whether the mouse is on a widget or moves one. ImGui knows where it was in the last frame; since then it may
        have come over from the panel to the picture."""
        imgui.set_current_context(self._imgui)
        imgui.internal.update_hovered_window_and_capture_flags(self._mouse)
        return self.io.want_capture_mouse

    @property
    def wants_keyboard(self) -> bool:
        return self.io.want_capture_keyboard or self.io.want_text_input

    def _fit_scale(self) -> None:
        """Scale text and widgets by the desktop's scale. On macOS window coordinates are scaled already."""
        width, pixels = glfw.get_window_size(self._window)[0], glfw.get_framebuffer_size(self._window)[0]
        scale = glfw.get_window_content_scale(self._window)[0] * max(width, 1) / max(pixels, 1)
        if pixels and scale != self.scale:
            imgui.get_style().scale_all_sizes(scale / self.scale)
            imgui.get_style().font_scale_dpi = self.scale = scale

    def _upload(self, commands: imgui.ImDrawList) -> None:
        """Upload the triangles of a draw list. The buffers grow if needed and never shrink."""
        for buffer, source, element in ((self._vertices, commands.vtx_buffer, imgui.VERTEX_SIZE),
                                        (self._indices, commands.idx_buffer, imgui.INDEX_SIZE)):
            size = source.size() * element
            buffer.orphan(max(size, buffer.size))
            if size:
                buffer.write(ctypes.string_at(source.data_address(), size))

    def _update(self, texture: imgui.ImTextureData) -> None:
        status = imgui.ImTextureStatus
        if texture.status == status.want_destroy:
            self._textures.pop(texture.tex_id).release()
            texture.set_tex_id(0)
            texture.set_status(status.destroyed)
            return
        if texture.status == status.want_create:
            created = self._gl.texture((texture.width, texture.height), 4)
            self._textures[created.glo] = created
            texture.set_tex_id(created.glo)
        if texture.status in (status.want_create, status.want_updates):
            self._textures[texture.tex_id].write(np.ascontiguousarray(texture.get_pixels_array()))
            texture.set_status(status.ok)

    def release(self) -> None:
        imgui.set_current_context(self._imgui)
        for texture in imgui.get_platform_io().textures:
            texture.set_tex_id(0)
            texture.set_status(imgui.ImTextureStatus.destroyed)
        self.io.backend_flags &= ~imgui.BackendFlags_.renderer_has_textures
        imgui.destroy_context(self._imgui)
        for thing in (*self._textures.values(), self._array, self._vertices, self._indices, self._program):
            thing.release()


def _clipboard(window: Any) -> str:
    text = glfw.get_clipboard_string(window)
    return text.decode(errors="replace") if text else ""


def _set_style(style: imgui.Style) -> None:
    """Set a dark and neutral style, so that the panel does not change how the picture's colours look."""
    style.window_rounding = style.window_border_size = 0.0
    style.frame_rounding = style.grab_rounding = style.popup_rounding = 3.0
    style.window_padding, style.frame_padding = imgui.ImVec2(12, 10), imgui.ImVec2(7, 3)
    style.item_spacing, style.item_inner_spacing = imgui.ImVec2(8, 5), imgui.ImVec2(6, 4)
    style.scrollbar_size, style.grab_min_size = 10.0, 10.0
    accent, accent_hover = (0.26, 0.46, 0.70), (0.33, 0.56, 0.84)
    knob, knob_active = (0.17, 0.30, 0.46), (0.20, 0.35, 0.53)  # dark: a slider's number stands on it
    colors = {
        "text": (0.90, 0.90, 0.90, 1.0), "text_disabled": (0.58, 0.58, 0.58, 1.0),
        "window_bg": (0.11, 0.11, 0.11, 1.0), "popup_bg": (0.14, 0.14, 0.14, 0.98), "border": (0.26, 0.26, 0.26, 1.0),
        "frame_bg": (0.20, 0.20, 0.20, 1.0), "frame_bg_hovered": (0.25, 0.25, 0.25, 1.0),
        "frame_bg_active": (0.28, 0.28, 0.28, 1.0), "header": (0.18, 0.18, 0.18, 1.0),
        "header_hovered": (0.24, 0.24, 0.24, 1.0), "header_active": (0.27, 0.27, 0.27, 1.0),
        "button": (0.24, 0.24, 0.24, 1.0), "button_hovered": (0.30, 0.30, 0.30, 1.0), "button_active": (*accent, 1.0),
        "slider_grab": (*knob, 1.0), "slider_grab_active": (*knob_active, 1.0), "check_mark": (*accent_hover, 1.0),
        "plot_lines": (*accent_hover, 1.0), "scrollbar_bg": (0.0, 0.0, 0.0, 0.0), "separator": (0.26, 0.26, 0.26, 1.0),
    }
    for name, color in colors.items():
        style.set_color_(getattr(imgui.Col_, name), imgui.ImVec4(*color))
