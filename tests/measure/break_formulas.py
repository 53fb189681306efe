"""Proves `pbr-viewer check`: plants wrong formulas one at a time and lists which checks break.

    python tests/measure/break_formulas.py [NAME...]

Exits with status 1 where one goes unnoticed. Takes minutes: no part of the test run.
"""

from __future__ import annotations

import sys
from collections import Counter

from mutations import MUTATIONS, planted

from viewer.measure.check.run import run_checks


def main(names: list[str]) -> int:
    unnoticed = 0
    print("| planted | checks that break |\n|---|---|")
    for mutation in MUTATIONS:
        if names and not any(name in mutation.name for name in names):
            continue
        with planted(mutation):
            broken = Counter(check.check for check in run_checks("all", quiet=True) if check.is_defect)
        print(f"| {mutation.name} | {', '.join(f'{name} ({n})' for name, n in broken.items()) or 'NONE'} |", flush=True)
        unnoticed += not broken
    return min(unnoticed, 1)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
