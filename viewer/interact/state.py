"""The state of the window as plain data. Keys, mouse and panel change it, and the window draws it."""

from __future__ import annotations

import time
from dataclasses import dataclass, field, replace
from typing import Any, get_args

from ..errors import ViewerError
from ..plan.legend import VIEW_NAMES
from ..quality import DETERMINED, Quality, QualityName
from ..scene.environment import Environment
from ..scene.furnace import in_furnace
from ..scene.light import Light
from ..scene.scene import Scene
from ..settings import Denoise, Lobes, Mode, Settings, Show
from .playback import Playback

MESSAGE_SECONDS = 4.0
ADDED_LIGHT = "--light"
"""The name of lights that the user has added. They stay when another model is opened."""
FURNACE: dict[str, Any] = {"exposure": -1.0, "tonemap": "none", "background": "env", "lobes": "all", "show": "shaded"}
"""The settings of the white furnace. Radiance 1 is displayed as mid grey, so too bright surfaces are as visible as too
dark ones. One contribution alone is no test of it, since what the others reflect would be missing, and a view of values
has no light."""

VIEWS = ("pbr", "phong", "split", "uniform_diffuse", "specular", "directional_diffuse", "furnace", "path", "path_split")
"""The actions of keys that choose what is shown; viewer/interact/keys.py says it in words."""


@dataclass
class ViewState:
    """`split` is the position of the line between the modes `sides`, as a fraction of the width; None without a split.

    `before_furnace` is None except in the white furnace. There it is the original scene, and the original values of the
    settings in FURNACE.
    """

    scene: Scene
    settings: Settings
    split: float | None = None
    sides: tuple[Mode, Mode] = ("phong", "pbr")
    paused: bool = False
    """Whether path tracing is paused."""
    denoiser: Denoise = "fast"
    """The one to go back to where the noise is shown."""
    tells_error: bool = False
    """Whether the error of the picture is measured while it is at rest."""
    shows_error: bool = False
    """Whether the map of the error is shown in place of the picture."""
    panel: bool = True
    help: bool = False
    inertia: bool = False
    message: str = ""
    is_error: bool = False
    expires: float = 0.0
    has_edited_lights: bool = False
    """Whether lights of the file were changed or removed."""
    before_furnace: tuple[Scene, dict[str, Any]] | None = None
    playback: Playback = field(default_factory=Playback)
    quality: Quality = Quality()
    """Of the picture at rest."""

    @property
    def modes(self) -> tuple[Mode, ...]:
        """The modes that are shown, from left to right."""
        return self.sides if self.split is not None else (self.settings.mode,)

    def shows(self, mode: Mode) -> bool:
        return mode in self.modes

    def show_view(self, view: str) -> None:
        """Show one of VIEWS, whatever was shown before.

        The key of the white furnace also leaves it, and those of the other views do, too. The panel's choice of a mode
        keeps it.
        """
        if view == "furnace":
            self.toggle_furnace()
            return
        self.leave_furnace()
        if view == "split":
            self.show_split()
        elif view == "path_split":
            self.show_split("pbr", "path")
        elif view in get_args(Mode):
            self.show_mode(view)  # type: ignore[arg-type]
        else:
            self.show_lobes(view.replace("_", "-"))  # type: ignore[arg-type]

    def show_mode(self, mode: Mode, lobes: Lobes = "all") -> None:
        self.split, self.paused = None, False
        self.settings = replace(self.settings, mode=mode, lobes=lobes, show="shaded")

    def show_values(self, show: Show) -> None:
        """Show one of the views for teaching and debugging, or the shaded picture, in the real-time mode that is shown,
        or else in mode pbr."""
        mode: Mode = "phong" if self.modes == ("phong",) else "pbr"
        self.show_mode(mode)
        self.settings = replace(self.settings, show=show)

    def toggle_wireframe(self) -> None:
        self.leave_furnace()
        self.show_values("shaded" if self.settings.show == "wireframe" else "wireframe")

    def toggle_grid(self) -> None:
        self.settings = replace(self.settings, grid="off" if self.settings.grid == "on" else "on")
        if self.modes == ("path",):
            self.say("The grid is drawn by the real-time modes")

    def step_values(self, step: int) -> None:
        """Show the view that is so many steps after this one, in the order of their names."""
        self.leave_furnace()
        shows = list(VIEW_NAMES)
        self.show_values(shows[(shows.index(self.settings.show) + step) % len(shows)])

    @property
    def at_rest(self) -> Settings:
        """The settings of the picture at rest, which has the chosen quality."""
        return self.quality.applied(self.settings)

    def choose(self, name: str, value: Any) -> None:
        """Change a setting. From then on it is the user's and not the quality's."""
        self.settings = replace(self.settings, **{name: value})
        self.quality = replace(self.quality, given=self.quality.given | {name})

    def choose_quality(self, name: QualityName) -> None:
        """Show pictures at rest at this quality, in all settings that the qualities differ in."""
        plain = Settings()
        self.settings = replace(self.settings, **{name: getattr(plain, name) for name in DETERMINED})
        self.quality = Quality(name)

    def show_lobes(self, lobes: Lobes) -> None:
        """Show one contribution alone, in mode path if that is shown, else in mode pbr."""
        self.show_mode("path" if self.modes == ("path",) else "pbr", lobes)

    def show_split(self, left: Mode = "phong", right: Mode = "pbr") -> None:
        self.split, self.paused = 0.5 if self.split is None else self.split, False
        self.sides = left, right
        self.settings = replace(self.settings, lobes="all", show="shaded")

    def toggle_pause(self) -> None:
        if self.shows("path"):
            self.paused = not self.paused
        else:
            self.say("There is nothing to pause: this picture is not path-traced")

    @property
    def has_error(self) -> bool:
        """Whether the picture is one whose error can be told: of one mode alone, shaded, without a grid."""
        settings = self.settings
        return self.split is None and settings.show == "shaded" and settings.grid == "off"

    def toggle_error(self, shows: bool = False) -> None:
        """Tell the error of the picture at rest, or stop that; with `shows`, its map takes turns with the picture."""
        if not self.has_error:
            self.say("The error is told of shaded pictures of one mode, without a grid")
            return
        self.shows_error = shows and not self.shows_error
        self.tells_error = shows or not self.tells_error

    def toggle_denoise(self) -> None:
        if self.settings.denoise == "off":
            self.settings = replace(self.settings, denoise=self.denoiser)
        else:
            self.denoiser = self.settings.denoise
            self.settings = replace(self.settings, denoise="off")
        self.say(f"Path tracing: denoising {'off' if self.settings.denoise == 'off' else 'on'}")

    def toggle_play(self) -> None:
        """Play the animation, the first one if none is chosen, or stand still."""
        if self._has_animation():
            self.playback.is_playing = not self.playback.is_playing

    def step_animation(self, seconds: float) -> None:
        """Stand still so much later, in the first animation if none is chosen."""
        if self._has_animation():
            self.seek(self.playback.time + seconds)

    def _has_animation(self) -> bool:
        """Choose the first animation if none is chosen. Returns whether there is one."""
        if not self.scene.animations:
            self.say("The model has no animations")
        elif self.playback.animation is None:
            self.show_animation(0)
        return bool(self.scene.animations)

    def show_animation(self, number: int | None) -> None:
        """Show another animation from its beginning, playing or not as before; None is the model at rest."""
        self.playback.animation, self.playback.time = number, 0.0
        self.playback.is_playing &= number is not None
        self._pose()

    def show_next_animation(self) -> None:
        """The one after the last one is the model at rest."""
        animations, current = self.scene.animations, self.playback.animation
        if not animations:
            self.say("The model has no animations")
            return
        number = 0 if current is None else current + 1
        self.show_animation(number if number < len(animations) else None)
        at_rest = self.playback.animation is None
        self.say("At rest" if at_rest else f"Animation {number + 1} of {len(animations)}: {animations[number].name}")

    def seek(self, time: float) -> None:
        """Stand still at this time of the animation."""
        if self.playback.animation is not None:
            self.playback.is_playing = False
            self.playback.time = min(max(time, 0.0), self.playback.duration(self.scene))
            self._pose()

    def play(self, seconds: float) -> bool:
        """Go on by so much of the clock, if the animation plays. Returns whether it does."""
        if self.playback.is_playing:
            self.playback.advance(self.scene, seconds)
            self._pose()
        return self.playback.is_playing

    def _pose(self) -> None:
        """Move the scene, and the one before the furnace, to the time of the animation."""
        try:
            if self.before_furnace is None:
                self.scene = self.playback.pose(self.scene)
                return
            scene, settings = self.before_furnace
            scene = self.playback.pose(scene)
        except ViewerError as error:
            self.playback.is_playing = False
            self.say(str(error), is_error=True)
        else:
            self.scene, self.before_furnace = in_furnace(scene), (scene, settings)

    def toggle_furnace(self) -> None:
        """Show the scene in the white furnace (viewer/scene/furnace.py), or leave the furnace."""
        if self.before_furnace is None:
            self.before_furnace = self.scene, {name: getattr(self.settings, name) for name in FURNACE}
            self.scene, self.settings = in_furnace(self.scene), replace(self.settings, **FURNACE)
            self.say("White furnace: surfaces that lose no light are invisible")
        else:
            self.leave_furnace()

    def leave_furnace(self) -> None:
        """Show the scene in its own materials and light again, if it is in the furnace."""
        if self.before_furnace is not None:
            self.scene, settings = self.before_furnace
            self.settings, self.before_furnace = replace(self.settings, **settings), None

    def shown(self) -> dict[str, object]:
        """The current values of the fields that determine the picture."""
        return {"scene": self.scene, "settings": self.settings, "split": self.split, "sides": self.sides,
                "before_furnace": self.before_furnace, "quality": self.quality,
                "playback": replace(self.playback, is_playing=False)}

    def say(self, text: str, is_error: bool = False) -> None:
        """Show one line over the picture: for some seconds, or, for an error, until the next message or Esc."""
        self.message, self.is_error = " ".join(text.split()), is_error
        self.expires = float("inf") if is_error else time.monotonic() + MESSAGE_SECONDS

    def forget_message(self) -> bool:
        """Remove an expired message. Returns whether there was one."""
        if self.message and time.monotonic() > self.expires:
            self.message = ""
            return True
        return False

    def choose_variant(self, name: str) -> None:
        """Show the model in the materials of a variant, "" for the file's own choice. This leaves the furnace."""
        self.leave_furnace()
        self.scene = self.scene.with_variant(name)

    def relight(self, environment: Environment | None) -> None:
        """Replace the environment, and keep the rotation and intensity of the one before. This leaves the furnace."""
        self.leave_furnace()
        old = self.scene.environment
        if environment is not None and old is not None:
            environment = replace(environment, rotation=old.rotation, intensity=old.intensity)
        self.scene = self.scene.relit(environment=environment)

    def set_lights(self, lights: tuple[Light, ...]) -> None:
        kept = [[light for light in each if light.name != ADDED_LIGHT] for each in (self.scene.lights, lights)]
        self.has_edited_lights |= kept[0] != kept[1]
        self.scene = self.scene.relit(lights=lights)

    def open(self, scene: Scene, again: bool = False) -> None:
        """Show another model, with the same environment and the lights that the user has added.

        With `again` it is a newer version of the model that is shown, which keeps its variant and its place in its
        animation."""
        self.leave_furnace()
        if again and self.scene.variant in [variant.name for variant in scene.variants]:
            scene = scene.with_variant(self.scene.variant)
        self.has_edited_lights = False
        added = tuple(light for light in self.scene.lights if light.name == ADDED_LIGHT)
        self.scene = scene.relit(environment=self.scene.environment, lights=(*scene.lights, *added))
        number = self.playback.animation
        if again and number is not None and number < len(scene.animations):
            self.playback.time = min(self.playback.time, self.playback.duration(scene))
            self._pose()
        else:
            self.playback = Playback(speed=self.playback.speed)
