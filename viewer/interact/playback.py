"""Where the window is in which animation, and how fast it plays."""

from __future__ import annotations

from dataclasses import dataclass

from ..scene.scene import Scene

SPEEDS = 0.1, 10.0
"""The slowest and the fastest that the panel offers."""
STEP_SECONDS = 1 / 25
"""The step of the keys that go back and forth."""


@dataclass
class Playback:
    """`animation` is a number, or None for the model at rest. `time` is in its seconds, which pass `speed` times as
    fast as those of the clock while it `is_playing`.
    """

    animation: int | None = None
    time: float = 0.0
    speed: float = 1.0
    is_playing: bool = False

    def duration(self, scene: Scene) -> float:
        return scene.animations[self.animation].duration if self.animation is not None else 0.0

    def advance(self, scene: Scene, seconds: float) -> None:
        """Go on by so much of the clock, from the end back to the beginning."""
        duration = self.duration(scene)
        self.time = (self.time + seconds * self.speed) % duration if duration > 0 else 0.0

    def pose(self, scene: Scene) -> Scene:
        """`scene`, of any pose, at this time."""
        return scene.at(self.time, self.animation)
