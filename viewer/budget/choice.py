"""What was weighed, what was taken, and how that is told."""

from __future__ import annotations

from dataclasses import dataclass, field
from operator import attrgetter, itemgetter
from typing import Any

from .candidates import Candidate

TOLERANCE = 1.2
"""How many times the budget may be taken before it counts as not held."""


@dataclass
class Choice:
    """What was weighed and what came of it. `seconds` is from the call to the picture in memory."""

    found: list[Candidate]
    taken: Candidate
    budget: float | None = None
    target: float | None = None
    seconds: float = 0.0
    samples: float | None = None
    """A pixel; of a path-traced picture."""
    error: float | None = None
    """Relative, of this very picture as its samples tell; None: it is `taken.error`, what is usual."""
    held: list[tuple[Candidate, float]] = field(default_factory=list)
    """Pictures of the raster that were made too, and their errors against the path-traced one."""
    beaten: Candidate | None = None
    """The path-traced picture that one of them was nearer to the truth than, with the error its samples tell."""
    unfinished: Candidate | None = None
    """What was meant to be made, and came to nothing in that time."""
    has_media: bool = False
    """Whether there is fog or a volume, with which no times and errors have been measured."""

    @property
    def is_drawn(self) -> bool:
        """Whether it is of the raster, and no paths have been tried."""
        return self.samples is None and self.beaten is None and self.unfinished is None

    @property
    def unmet(self) -> str:
        """What was asked for, or expected, and could not be had; "": all could."""
        if self.budget is not None and self.seconds > TOLERANCE * self.budget:
            if not self.taken.fits(self.budget):
                return f"nothing is ready within {self.budget:g} s here, preparing the scene included"
            return "slower than expected"
        if self.target is not None and (self.error is None or self.error > self.target):
            return "the error asked for was not reached" if self.error is not None else \
                "whether that error is met is not known: there was no time to trace paths"
        if self.unfinished is not None:
            return f"{self.unfinished.title}: slower than expected, it came to nothing"
        return ""

    def to_json(self) -> dict[str, Any]:
        return {"method": self.taken.title, "seconds": self.seconds, "spp": self.samples,
                "error": self.taken.error if self.error is None else self.error,
                "error_is": "measured" if self.error is not None else
                            "expected without fog and volumes" if self.has_media else "expected",
                "time_budget": self.budget, "error_target": self.target, "unmet": self.unmet or None,
                "candidates": [one.to_json() for one in self.found],
                "unfinished": self.unfinished and self.unfinished.title,
                "compared": [{"method": one.title, "error": error} for one, error in self.held]
                            + ([{"method": self.beaten.title, "error": self.beaten.error}] if self.beaten else [])}

    def __str__(self) -> str:
        """In a line."""
        wish = [] if self.budget is None else [f"time budget {self.budget:g} s"]
        wish += [] if self.target is None else [f"error {self.target:g}"]
        words = self.taken.title + ("" if self.samples is None else f", {self.samples:.3g} samples a pixel")
        words += f", in {self.seconds:.2g} s"
        words += f"; expected error {self.taken.error:.2g}" if self.error is None else f"; error {self.error:.2g}"
        words += " without fog and volumes, with which it is not known" * (self.error is None and self.has_media)
        other = self._runner_up()
        words += f"; {other[0]}: {other[1]:.2g}" if other else ""
        return f"{', '.join(wish)}: {words}" + (f" ({self.unmet})" if self.unmet else "")

    def _runner_up(self) -> tuple[str, float] | None:
        """The best of the other kind that there was time for."""
        if self.taken.is_traced and self.held:
            best, error = min(self.held, key=itemgetter(1))
            return best.title, error
        if self.beaten is not None:
            return self.beaten.title, self.beaten.error
        other = [one for one in self.found if one.is_traced != self.taken.is_traced and one.fits(self.budget)
                 and self.unfinished is None]
        best_other = min(other, key=attrgetter("error"), default=None)
        return None if best_other is None else (best_other.title, best_other.error)
