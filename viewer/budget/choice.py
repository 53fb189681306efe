"""How a picture in a time budget was made, in words and as JSON."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from ..estimate.raster_error import percent
from .combine import Told

TOLERANCE = 1.2
"""How many times the budget may be taken before it counts as not held."""


@dataclass
class Choice:
    """`seconds` is from the call to the picture in memory."""

    budget: float | None = None
    target: float | None = None
    method: str = ""
    seconds: float = 0.0
    ready: float | None = None
    """Seconds to the first picture of the raster, if there was one."""
    samples: float | None = None
    """A pixel, of paths that are in the picture."""
    told: Told | None = None
    """What the paths say of the picture; None if there were not enough."""
    error: float | None = None
    """Relative, of a picture of paths alone, as they estimate it."""
    candidates: list[dict[str, Any]] = field(default_factory=list)
    """Of the raster: "method", "expected_s" and the "seconds" it took, None if it was not drawn."""
    compared: dict[str, float] = field(default_factory=dict)
    """Relative errors of all the pictures there were to choose from, by their methods."""
    unfinished: str | None = None
    """What was begun and came to nothing."""

    @property
    def measured(self) -> float | None:
        return self.told.relative if self.told is not None else self.error

    @property
    def reached(self) -> float | None:
        """What is sure enough to be held against the target."""
        return self.told.high**0.5 if self.told is not None else self.error

    @property
    def unmet(self) -> str:
        """What was asked for and could not be had; "": all could."""
        if self.budget is not None and self.seconds > TOLERANCE * self.budget:
            if self.ready is not None and self.ready <= TOLERANCE * self.budget:
                return "it took longer than estimated"
            return f"no picture can be ready within {self.budget:g} s here, since the scene has to be prepared"
        if self.target is not None and (self.reached is None or self.reached > self.target):
            return "the requested error was not reached" if self.reached is not None else \
                "it is not known whether the error is met: there was no time to trace paths"
        return "" if self.unfinished is None else f"{self.unfinished}: no time for enough samples"

    def to_json(self) -> dict[str, Any]:
        return {"method": self.method, "seconds": self.seconds, "spp": self.samples, "error": self.measured,
                "error_low": self.told and self.told.low**0.5, "error_high": self.told and self.told.high**0.5,
                "error_is": "not measured" if self.measured is None else "measured",
                "time_budget": self.budget, "error_target": self.target, "unmet": self.unmet or None,
                "candidates": self.candidates, "unfinished": self.unfinished,
                "compared": [{"method": method, "error": error} for method, error in self.compared.items()]}

    def __str__(self) -> str:
        """In a line."""
        wish = [] if self.budget is None else [f"time budget {self.budget:g} s"]
        wish += [] if self.target is None else [f"error {self.target:g}"]
        words = self.method + ("" if self.samples is None else f", {self.samples:.3g} samples a pixel")
        words += f", in {self.seconds:.2g} s; "
        if self.told is not None:
            low, high = (percent(end**0.5) for end in (self.told.low, self.told.high))
            words += f"{percent(self.told.relative)} % from the truth (95 % sure: {low} to {high} %)"
        else:
            words += "error not measured" if self.error is None else f"error {self.error:.2g}"
        others = [f"{method}: {percent(error)} %" for method, error in self.compared.items() if method != self.method]
        return f"{', '.join(wish)}: {'; '.join([words, *others])}" + (f" ({self.unmet})" if self.unmet else "")
