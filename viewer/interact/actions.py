"""What keys do to a view, without a toolkit: `viewer.interact.keys` lists them."""

from __future__ import annotations

import math
from collections.abc import Callable

from ..scene.camera import DEFAULT_AZIMUTH, DEFAULT_ELEVATION, Camera
from .orbit import QUARTER, OrbitController
from .pick import pick
from .playback import STEP_SECONDS
from .state import VIEWS, ViewState

_DIRECTIONS = {
    "view_front": (0.0, 0.0), "view_back": (math.pi, 0.0), "view_right": (QUARTER, 0.0), "view_left": (-QUARTER, 0.0),
    "view_top": (0.0, QUARTER), "view_bottom": (0.0, -QUARTER), "view_default": (DEFAULT_AZIMUTH, DEFAULT_ELEVATION),
}


class Actions:
    """Does the actions that concern `state` and `orbit`. `aspect()` is that of the picture."""

    def __init__(self, state: ViewState, orbit: OrbitController, aspect: Callable[[], float]) -> None:
        self._state, self._orbit, self._aspect = state, orbit, aspect
        self._next_camera = 0
        self._others: dict[str, Callable[[], object]] = {
            "next_values": lambda: state.step_values(1), "previous_values": lambda: state.step_values(-1),
            "wireframe": state.toggle_wireframe, "grid": state.toggle_grid,
            "inertia": self._toggle_inertia, "pause": state.toggle_pause, "denoise": state.toggle_denoise,
            "tell_error": state.toggle_error, "error_map": lambda: state.toggle_error(shows=True),
            "play": state.toggle_play, "next_animation": state.show_next_animation,
            "step_back": lambda: state.step_animation(-STEP_SECONDS),
            "step_on": lambda: state.step_animation(STEP_SECONDS),
            "frame_all": self.frame_all, "orthographic": self._toggle_orthographic,
            "next_camera": self._show_next_camera,
        }

    @property
    def names(self) -> set[str]:
        """All that `do` does."""
        return {*VIEWS, *_DIRECTIONS, *self._others}

    def do(self, action: str) -> bool:
        """Do `action`. Returns whether it is one that concerns the view."""
        if action in VIEWS:
            self._state.show_view(action)
        elif action in _DIRECTIONS:
            self._orbit.look_from(*_DIRECTIONS[action])
        elif action in self._others:
            self._others[action]()
        else:
            return False
        return True

    def frame_all(self) -> None:
        self._orbit.frame_all(self._aspect())

    def begin_again(self) -> None:
        """Frame another scene, and begin with the first of its cameras."""
        self._orbit.set_scene(self._state.scene)
        self.frame_all()
        self._next_camera = 0

    def follow(self, camera: Camera) -> None:
        """Take over a camera. The orbit's target becomes the point that it looks at."""
        scene = self._state.scene
        point = pick(scene, camera, (2, 2), (1, 1))
        depth = float(((scene.center if point is None else point) - camera.eye) @ camera.forward)
        self._orbit.follow(camera, depth if depth > 1e-6 * scene.radius else scene.radius)

    def _toggle_inertia(self) -> None:
        self._state.inertia = not self._state.inertia
        self._state.say(f"Inertia {'on' if self._state.inertia else 'off'}")

    def _toggle_orthographic(self) -> None:
        self._orbit.is_orthographic = not self._orbit.is_orthographic

    def _show_next_camera(self) -> None:
        cameras = self._state.scene.cameras
        if not cameras:
            self._state.say("The file has no cameras")
            return
        number = self._next_camera % len(cameras)
        self._next_camera = number + 1
        self.follow(cameras[number])
        self._state.say(f"Camera {number + 1} of {len(cameras)} {cameras[number].name}")
