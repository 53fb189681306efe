"""What a check found: one row a case, with its figure and its bound."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass


@dataclass(frozen=True)
class Check:
    """`value` is to be `bound` at most; NaN never is.

    `expected` marks a model that is known to break the bound: that it does so is a result, that it does not a defect.
    `note` says what the row alone does not: units in the last place, the limit of the number format.
    """

    check: str
    case: str
    value: float
    bound: float
    expected: bool = False
    note: str = ""

    @property
    def passed(self) -> bool:
        return self.value <= self.bound

    @property
    def is_defect(self) -> bool:
        """A bound that is broken, or a known failure that has gone."""
        return self.passed == self.expected

    def to_json(self) -> dict[str, object]:
        """Ready for JSON, which has no NaN and no infinity: null stands for them."""
        value = float(self.value) if math.isfinite(self.value) else None
        return {"check": self.check, "case": self.case, "value": value, "bound": float(self.bound),
                "pass": bool(self.passed), "expected": self.expected, "note": self.note}


def exit_status(checks: Iterable[Check]) -> int:
    """1 where any row is a defect."""
    return int(any(check.is_defect for check in checks))


def summary(checks: Iterable[Check]) -> str:
    """One line: how many passed, failed as expected, and are defects."""
    checks = list(checks)
    defects = sum(check.is_defect for check in checks)
    known = sum(check.expected and not check.passed for check in checks)
    parts = [f"{len(checks)} checks", f"{len(checks) - defects - known} passed"]
    parts += [f"{known} failed as this model is known to"] if known else []
    return ", ".join([*parts, f"{defects} broken" if defects else "none broken"])
