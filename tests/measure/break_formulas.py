"""Proves `pbr-viewer check`: plants wrong formulas one at a time and lists which checks fail.

    python tests/measure/break_formulas.py [NAME...]

Exits with status 1 where one goes unnoticed. Takes minutes: no part of the test run.
"""

from __future__ import annotations

import sys
from collections import Counter
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from mutations import Mutation, try_all
from wrong_formulas import WRONG_FORMULAS

from viewer.measure.check.run import run_checks


def failing_checks(_: Mutation) -> list[str]:
    """The checks that fail, with the number of rows."""
    failing = Counter(check.check for check in run_checks("all", quiet=True) if check.is_defect)
    return [f"{name} ({count})" for name, count in failing.items()]


if __name__ == "__main__":
    sys.exit(try_all(WRONG_FORMULAS, sys.argv[1:], failing_checks))
