"""The results of the checks: a row for each case, with its value and its bound."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass


@dataclass(frozen=True)
class Check:
    """Passes if `value` is at most `bound`; NaN does not pass.

    `expected` marks a model that is known to fail: then failing is a result, and passing is a defect. `note` adds what
    the value does not show: where it is worst, units in the last place, the limit of the number format.
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
        """A failure that is not expected, or an expected one that did not happen."""
        return self.passed == self.expected

    def to_json(self) -> dict[str, object]:
        """Ready for JSON; a value that is not finite becomes null."""
        value = float(self.value) if math.isfinite(self.value) else None
        return {"check": self.check, "case": self.case, "value": value, "bound": float(self.bound),
                "pass": bool(self.passed), "expected": self.expected, "note": self.note}


def exit_status(checks: Iterable[Check]) -> int:
    """1 if any row is a defect."""
    return int(any(check.is_defect for check in checks))


def summary(checks: Iterable[Check]) -> str:
    """One line: how many passed, failed as expected, and are defects."""
    checks = list(checks)
    defects = sum(check.is_defect for check in checks)
    known = sum(check.expected and not check.passed for check in checks)
    parts = [f"{len(checks)} checks", f"{len(checks) - defects - known} passed"]
    parts += [f"{known} failed as expected"] if known else []
    return ", ".join([*parts, f"{defects} defects" if defects else "no defects"])
