"""The desktop window: its event loop, which draws only when something has changed."""

from __future__ import annotations

import math
import time
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import Self

import click
import glfw
import moderngl

from ..errors import InputError, ViewerError
from ..gpu.window import WindowContext
from ..interact.actions import Actions
from ..interact.command_line import command_line
from ..interact.model_files import ModelFiles
from ..interact.orbit import OrbitController
from ..interact.picture import Picture
from ..interact.playback import Playback
from ..interact.state import ViewState
from ..quality import DRAFT, Quality
from ..raster.renderer import Renderer
from ..scene.camera import Camera
from ..scene.environment_files import FORMATS, load_environment
from ..scene.scene import Scene
from ..settings import Settings
from .full_screen import FullScreen
from .gui import Gui
from .input import Input
from .overlay import draw_counts, draw_help, draw_message, draw_split, draw_status
from .panel import Panel, Readings
from .watch import INTERVAL, FileWatch, ShaderWatch

SETTLING_FRAMES = 3
"""The number of frames drawn after an event. ImGui needs more than one to lay out the panel."""
PANEL_FROM_WIDTH = 900
_CLEAR = (0.08, 0.08, 0.08, 1.0)


class ViewerWindow:
    """The window, one `step` at a time."""

    def __init__(self, scene: Scene, settings: Settings, camera: Camera | None = None,
                 size: tuple[int, int] = (1280, 720), use_cache: bool = True,
                 playback: Playback | None = None, quality: Quality = DRAFT, files: ModelFiles | None = None,
                 watch: bool = False, full_screen: bool = False) -> None:
        self.state = ViewState(scene, settings, panel=size[0] >= PANEL_FROM_WIDTH, playback=playback or Playback(),
                               quality=quality)
        self.context = WindowContext(size, _title(scene), visible=True)
        self.renderer = Renderer(self.context, use_cache)
        self.window = self.context.window
        self._gui = Gui(self.context, self.window)
        self.readings = Readings(f"{self.context.renderer}, OpenGL {self.context.version}")
        self._panel = Panel(self.state, self.readings, lambda path: self.open([path]), self._copy)
        self.orbit = OrbitController(scene, self._aspect)
        self._actions = Actions(self.state, self.orbit, lambda: self._aspect)
        if camera is not None:
            self._actions.follow(camera)
        self.picture = Picture(self.renderer, self.state, self.orbit)
        self._watch = ShaderWatch(self.renderer.programs)
        self._files, self._file_watch = files or ModelFiles(), FileWatch() if watch else None
        self._follow_files()
        self._full_screen = FullScreen(self.window)
        if full_screen:
            self._full_screen.toggle()
        self._input = Input(self.window, self.state, self.orbit, self._gui, self._picture_size, self.do, self.open)
        self._to_open: list[str] = []
        self._frames_left = SETTLING_FRAMES
        self._moved_at = time.monotonic()
        glfw.swap_interval(1)
        self._show_notice(f"Preparing {scene.name} …")

    @property
    def is_closed(self) -> bool:
        return bool(glfw.window_should_close(self.window))

    @property
    def needs_redraw(self) -> bool:
        """Whether something must be drawn at once. If not, the picture may still be refined or path traced."""
        return bool(self._frames_left or self._to_open or self.orbit.velocity.any() or self.state.playback.is_playing)

    def step(self, timeout: float = INTERVAL) -> None:
        """Wait for an event, at most `timeout` seconds. Then draw if there is anything new, and continue path
        tracing."""
        wait = 0.0 if self.needs_redraw else min(timeout, self.picture.seconds_until_work)
        if wait > 0:
            glfw.wait_events_timeout(wait)
        else:
            glfw.poll_events()
        if self._to_open:
            self._draw()  # shows the message "Opening ..."
            self._open_now()
        reloaded = self._watch.poll()
        if reloaded is not None:
            self._report_reload(reloaded)
        if self._file_watch is not None and self._file_watch.poll():
            self._load_again()
        now = time.monotonic()
        passed, self._moved_at = now - self._moved_at, now
        is_moving = self.orbit.coast(min(passed, 0.1)) | self.state.play(passed)
        has_news = self._input.changed or is_moving or self.picture.wants_refinement
        if self.state.forget_message() or has_news:
            self._input.changed, self._frames_left = False, SETTLING_FRAMES
        if self._frames_left:
            self._frames_left -= 1
            self._draw()
        if self.picture.converge():
            self._frames_left = max(self._frames_left, 1)

    def do(self, action: str) -> None:
        """Execute the action of a key; `viewer.interact.keys.KEYS` lists the actions."""
        if self._actions.do(action):
            return
        if action in ("panel", "help"):
            setattr(self.state, action, not getattr(self.state, action))
        else:
            {"screenshot": self._save, "reload": self._reload, "close": self._close,
             "copy_command": self._copy,
             "full_screen": self._full_screen.toggle, "next_file": lambda: self._open_beside(1),
             "previous_file": lambda: self._open_beside(-1)}[action]()

    def open(self, paths: list[str]) -> None:
        """Open models and environments, which differ by their extension, after a message was shown."""
        self._to_open = list(paths)
        self.state.say(f"Opening {Path(paths[0]).name} …")
        self._input.changed = True

    def _draw(self) -> None:
        if 0 in self._pixels:
            return
        start = time.perf_counter()
        self.context.make_current()
        is_new = self.picture.update(self._pixels)
        self.readings.left_out = self.picture.left_out
        self._gui.begin()
        scale, width = self._gui.scale, self._picture_size()[0]
        if self.state.split is not None:
            draw_split(self.state.split, self.state.sides, scale, width)
        if status := self.picture.status():
            draw_status(status, scale, width)
        if self.state.settings.show == "overdraw":
            draw_counts(scale)
        if self.state.panel:
            self._panel.draw(scale)
        if self.state.message:
            draw_message(self.state, scale, width)
        if self.state.help:
            draw_help(self.state, scale)
        screen = self._screen(self._pixels)
        self.picture.present(screen)
        screen.viewport = (0, 0, *glfw.get_framebuffer_size(self.window))
        self._gui.draw(screen)
        self.context.gl.finish()
        self.picture.was_shown()
        if is_new:
            glfw.set_window_title(self.window, _title(self.state.scene))
            self.readings.frame_ms.append((time.perf_counter() - start) * 1e3)
        glfw.swap_buffers(self.window)

    def _open_now(self) -> None:
        paths, self._to_open = self._to_open, []
        self.state.message = ""
        self._input.changed = True
        for path in paths:
            try:
                if Path(path).suffix.lower() in FORMATS:
                    environment = load_environment(Path(path))
                    environment.radiance  # noqa: B018  decode it here, where an error can be shown
                    self.state.relight(environment)
                else:
                    self._open_scene(self._files.load(path))
            except (ViewerError, OSError, MemoryError) as error:
                self.state.say(str(error) or f"{path}: out of memory", is_error=True)
        self._follow_files()

    def _open_scene(self, scene: Scene) -> None:
        self.state.open(scene)
        self._actions.begin_again()

    def _open_beside(self, step: int) -> None:
        try:
            self.open([self._files.beside(step)])
        except (InputError, OSError) as error:
            self.state.say(str(error), is_error=True)

    def _load_again(self) -> None:
        """Show the file as it is now, from the same camera at the same time of its animation."""
        path = self._files.path
        assert path is not None
        try:
            self.state.open(self._files.load(path), again=True)
            self.orbit.set_scene(self.state.scene)
            self.state.say(f"Loaded {Path(path).name} again")
        except (ViewerError, OSError, MemoryError) as error:
            self.state.say(str(error) or f"{path}: out of memory", is_error=True)
        self._follow_files()
        self._input.changed = True

    def _follow_files(self) -> None:
        if self._file_watch is not None:
            self._file_watch.follow(self._files.read)

    def _save(self) -> None:
        if 0 not in self._pixels:
            self.picture.save(self._pixels)

    def _copy(self) -> None:
        """Copy the picture as a command line, and print it."""
        progress = self.picture.paths.progress
        line = command_line(self.state, self.orbit, self._pixels, self._files, progress.samples if progress else None)
        glfw.set_clipboard_string(None, str(line))
        with suppress(OSError):
            click.echo(str(line))
        self.state.say("Copied the command line" + (f", without {' and '.join(line.lost)}" if line.lost else ""))

    def _reload(self) -> None:
        self._report_reload(self._watch.reload())

    def _report_reload(self, error: str) -> None:
        self.state.say(error or "Shaders reloaded", is_error=bool(error))
        self._input.changed = True

    def _close(self) -> None:
        if self._gui.close_popups():
            pass
        elif self.state.help:
            self.state.help = False
        elif self.state.message and self.state.is_error:
            self.state.message = ""
        elif self._full_screen.is_on:
            self._full_screen.toggle()
        else:
            glfw.set_window_should_close(self.window, True)

    def _show_notice(self, text: str) -> None:
        """Show a message without a picture: the first picture may take long."""
        self._gui.begin()
        draw_message(replace(self.state, message=text), self._gui.scale, self._picture_size()[0])
        screen = self._screen(glfw.get_framebuffer_size(self.window))
        screen.clear(*_CLEAR)
        self._gui.draw(screen)
        glfw.swap_buffers(self.window)

    def _screen(self, pixels: tuple[int, int]) -> moderngl.Framebuffer:
        screen = self.context.gl.screen
        screen.viewport = (0, 0, *pixels)
        screen.scissor = None
        return screen

    def _picture_size(self) -> tuple[int, int]:
        """The size of the picture in window coordinates. It stands at the left of the panel, or below it in a window
        that is too narrow for both."""
        width, height = glfw.get_window_size(self.window)
        panel = math.ceil(self._panel.width(width, self._gui.scale))
        return width - panel if width >= 2 * panel else width, height

    @property
    def _aspect(self) -> float:
        width, height = self._pixels
        return max(width, 1) / max(height, 1)

    @property
    def _pixels(self) -> tuple[int, int]:
        """The size of the picture in pixels."""
        width, height = glfw.get_framebuffer_size(self.window)
        window_width = glfw.get_window_size(self.window)[0]
        return round(width * self._picture_size()[0] / max(window_width, 1)), height

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *exc: object) -> None:
        self.picture.release()
        self.renderer.release()
        self._gui.release()
        self.context.release()


def _title(scene: Scene) -> str:
    return f"{scene.name} — pbr-viewer"
