"""The values that a setting without a list of choices can have: numbers in a range, several of them, a weave."""

from __future__ import annotations

import math
from dataclasses import dataclass
from operator import index
from typing import Any

from .errors import UsageError

WEAVE_NAMES = ("plain", "twill", "satin", "denim")
"""Of `viewer.scene.weave.WEAVES`."""


@dataclass(frozen=True)
class Range:
    """The numbers that a setting can have: `low` to `high`, both included; also 0 if `or_zero`, and None, for "none",
    if `or_none`."""

    low: float
    high: float
    is_whole: bool = False
    or_zero: bool = False
    or_none: bool = False

    def number(self, value: object, prefix: str) -> Any:
        """`value` as a number in this range, an int if `is_whole`. Raises UsageError, which starts with `prefix`."""
        if self.or_none and value in (None, "none"):
            return None
        try:
            number = self._whole(value) if self.is_whole else float(value)  # type: ignore[arg-type]
        except (TypeError, ValueError):
            number = math.nan
        if not self.low <= number <= self.high and not (self.or_zero and number == 0):
            raise UsageError(f"{prefix} must be {self}")
        return number

    @staticmethod
    def _whole(value: object) -> int:
        return int(value) if isinstance(value, str) else index(value)  # type: ignore[arg-type]

    def __str__(self) -> str:
        return (f"{'none or ' * self.or_none}{'0 or ' * self.or_zero}a {'whole ' * self.is_whole}number from "
                f"{_plain(self.low)} to {_plain(self.high)}")


@dataclass(frozen=True)
class Several(Range):
    """As many numbers as `names` has, each in this range. By default a colour, in linear Rec. 709, for which one number
    stands for all."""

    names: str = "R,G,B"

    def number(self, value: object, prefix: str) -> Any:
        """`value`, a number, a sequence or text with commas, as a tuple of numbers. Raises UsageError as Range does."""
        if self.or_none and value in (None, "none"):
            return None
        parts = value.split(",") if isinstance(value, str) else value
        if isinstance(parts, (int, float)):
            parts = [parts]
        if not isinstance(parts, (list, tuple)) or len(parts) not in self._counts:
            raise UsageError(f"{prefix} must be {self}")
        try:
            numbers = [Range(self.low, self.high).number(part, prefix) for part in parts]
        except UsageError as error:
            raise UsageError(f"{prefix} must be {self}") from error
        return tuple(numbers * (self._counts[-1] // len(numbers)))

    @property
    def _counts(self) -> tuple[int, ...]:
        return (1, 3) if self.names == "R,G,B" else (self.names.count(",") + 1,)

    def __str__(self) -> str:
        words = " or ".join(["none"] * self.or_none + [_COUNTS[count] for count in self._counts])
        return f"{words} from {_plain(self.low)} to {_plain(self.high)}"


_COUNTS = {1: "one number", 2: "two numbers", 3: "three numbers"}


class WeaveName(Range):
    """A weave by its name or its file, and the material that is woven."""

    def __init__(self) -> None:
        super().__init__(0, 0)

    def number(self, value: object, prefix: str) -> Any:
        """`value` as it is. Raises UsageError for what is neither a name nor a file of JSON."""
        which = str(value).partition(",")[0]
        if which not in ("off", *WEAVE_NAMES) and not which.endswith(".json"):
            raise UsageError(f"{prefix} must be {self}")
        return str(value)

    def __str__(self) -> str:
        return f"off, {', '.join(WEAVE_NAMES)} or FILE.json, and a comma and a material's name for that one alone"


def _plain(number: float) -> str:
    return str(number) if isinstance(number, int) else f"{number:g}"
