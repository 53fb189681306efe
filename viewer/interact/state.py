"""What the window shows, as plain data: changed by keys, mouse and panel, drawn by the window."""

from __future__ import annotations

import time
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from ..scene.environment import Environment
from ..scene.furnace import in_furnace
from ..scene.light import Light
from ..scene.scene import Scene
from ..settings import Lobes, Mode, Settings, ignored

Part = tuple[int, int, int, int]

CLEAR_GREY = (0.03, 0.03, 0.03)
"""What stands behind a model without background on screen, in linear Rec. 709: a window has no alpha."""
MESSAGE_SECONDS = 4.0
ADDED_LIGHT = "--light"
"""The name of lights the user added: they stay when another model is opened."""
FURNACE: dict[str, Any] = {"exposure": -1.0, "tonemap": "none", "background": "env"}
"""Settings of the furnace view: radiance 1 is mid grey, so that a surface too bright shows as well as one too dark."""


@dataclass
class ViewState:
    """`split` is where the line between the modes `sides` stands, as a fraction of the width, or None.

    `unheated` is the scene, with its settings in FURNACE's terms, to come back to from the furnace view; else None.
    """

    scene: Scene
    settings: Settings
    split: float | None = None
    sides: tuple[Mode, Mode] = ("phong", "pbr")
    paused: bool = False
    """Whether the path-traced picture shall stay as it is."""
    panel: bool = True
    help: bool = False
    inertia: bool = False
    message: str = ""
    is_error: bool = False
    expires: float = 0.0
    unheated: tuple[Scene, dict[str, Any]] | None = None

    @property
    def modes(self) -> tuple[Mode, ...]:
        """What is shown, from left to right."""
        return self.sides if self.split is not None else (self.settings.mode,)

    def shows(self, mode: Mode) -> bool:
        return mode in self.modes

    def show_mode(self, mode: Mode, lobes: Lobes = "all") -> None:
        self.split, self.paused = None, False
        self.settings = replace(self.settings, mode=mode, lobes=lobes)

    def show_lobes(self, lobes: Lobes) -> None:
        """One contribution alone, in a mode that has them."""
        self.show_mode("path" if self.modes == ("path",) else "pbr", lobes)

    def show_split(self, left: Mode = "phong", right: Mode = "pbr") -> None:
        self.split, self.paused = 0.5 if self.split is None else self.split, False
        self.sides = left, right
        self.settings = replace(self.settings, lobes="all")

    def toggle_pause(self) -> None:
        if self.shows("path"):
            self.paused = not self.paused
        else:
            self.say("Nothing to pause: this picture is not path-traced")

    def toggle_denoise(self) -> None:
        self.settings = replace(self.settings, denoise="fast" if self.settings.denoise == "off" else "off")
        self.say(f"Path tracing: noise {'is filtered away' if self.settings.denoise == 'fast' else 'is left as it is'}")

    def toggle_furnace(self) -> None:
        """The model white and in a white furnace, where what keeps all light vanishes; or back."""
        if self.unheated is None:
            self.unheated = self.scene, {name: getattr(self.settings, name) for name in FURNACE}
            self.scene, self.settings = in_furnace(self.scene), replace(self.settings, **FURNACE)
            self.say("White furnace: what keeps all light vanishes")
        else:
            self.scene, settings = self.unheated
            self.settings, self.unheated = replace(self.settings, **settings), None

    def shown(self) -> dict[str, object]:
        """The fields that decide what the picture shows, as they are now."""
        return {"scene": self.scene, "settings": self.settings, "split": self.split, "sides": self.sides,
                "unheated": self.unheated}

    def say(self, text: str, is_error: bool = False) -> None:
        """One line over the picture: for some seconds, or until the next one or Esc where it is an error."""
        self.message, self.is_error = " ".join(text.split()), is_error
        self.expires = float("inf") if is_error else time.monotonic() + MESSAGE_SECONDS

    def forget_message(self) -> bool:
        """Drop a message whose time is over; whether there was one."""
        if self.message and time.monotonic() > self.expires:
            self.message = ""
            return True
        return False

    def relight(self, environment: Environment | None) -> None:
        """Another environment, turned and scaled as the one before."""
        old = self.scene.environment
        if environment is not None and old is not None:
            environment = replace(environment, rotation=old.rotation, intensity=old.intensity)
        self.scene = self.scene.relit(environment=environment)

    def set_lights(self, lights: tuple[Light, ...]) -> None:
        self.scene = self.scene.relit(lights=lights)

    def open(self, scene: Scene) -> None:
        """Another model under the same environment and the lights that were added by hand."""
        if self.unheated is not None:
            self.toggle_furnace()
        added = tuple(light for light in self.scene.lights if light.name == ADDED_LIGHT)
        self.scene = scene.relit(environment=self.scene.environment, lights=(*scene.lights, *added))

    def on_screen(self) -> Settings:
        """The settings as a window can show them."""
        if self.settings.background != "none":
            return self.settings
        return replace(self.settings, background=CLEAR_GREY)

    def shots(self, settings: Settings, size: tuple[int, int]) -> list[tuple[Settings, Part | None]]:
        """What the raster draws for a picture of `size` pixels: settings, and the part of the picture or None for all.

        Where paths are traced it draws all of what stands beside them or, until they have a picture, in their place.
        """
        plain = Settings()
        settings = replace(settings, **{name: getattr(plain, name) for name in ignored("pbr", "phong")})
        if self.shows("path"):
            beside: Mode = next((mode for mode in self.modes if mode != "path"), "pbr")
            return [(replace(settings, mode=beside), None)]
        return [(replace(settings, mode=mode), part) for mode, part in self.parts(size)]

    def parts(self, size: tuple[int, int]) -> list[tuple[Mode, Part | None]]:
        """The modes that are seen, and where: None is all of the picture."""
        if self.split is None:
            return [(self.settings.mode, None)]
        width, height = size
        line = min(max(round(self.split * width), 0), width)
        parts = zip(self.sides, ((0, 0, line, height), (line, 0, width - line, height)), strict=True)
        return [(mode, part) for mode, part in parts if part[2] > 0]


def free_path(folder: Path, name: str, suffix: str = ".png") -> Path:
    """`name-1.png`, or the first number that no file there has; characters no file system wants become `_`."""
    stem = "".join(c if c.isalnum() or c in "-_. " else "_" for c in name).strip(" .") or "picture"
    number = 1
    while (path := folder / f"{stem}-{number}{suffix}").exists():
        number += 1
    return path


def scene_facts(scene: Scene) -> list[tuple[str, str]]:
    """Name and value of what there is to know about a model at a glance."""
    extent = scene.bounds[1] - scene.bounds[0]
    textures = {id(t.image) for m in scene.materials for t in vars(m).values() if hasattr(t, "image")}
    facts = [
        ("Triangles", f"{scene.triangle_count:,}"),
        ("Instances", f"{len(scene.instances):,} of {len(scene.meshes):,} meshes"),
        ("Materials", f"{len(scene.materials)}, {len(textures)} images"),
        ("Size", " × ".join(f"{side:.3g}" for side in extent) + " m"),
        ("Lights", str(len(scene.lights))),
        ("Cameras", str(len(scene.cameras))),
    ]
    told = {name.lower() for name, _ in facts}
    return facts + [(name.replace("_", " ").capitalize(), _text(value)) for name, value in scene.facts.items()
                    if value and name not in told]


def _text(value: object) -> str:
    return ", ".join(map(str, value)) if isinstance(value, (list, tuple)) else str(value)
