"""Draws all pictures with all drivers, one after another, and tells how far they are from llvmpipe's: minutes.

    python tests/drivers/run.py [FILE]      # FILE gets the table, in Markdown
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
from datetime import date
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))

from drivers import DRIVERS, REFERENCE, Run, differences  # noqa: E402


def main() -> None:
    commit = subprocess.run(["git", "rev-parse", "--short", "HEAD"], capture_output=True, text=True, cwd=ROOT).stdout
    lines = [f"# Drivers, {date.today()}, {commit.strip()}", "",
             "Mean FLIP against llvmpipe's pictures, made by `python tests/drivers/run.py`. *equal*: to the bit.", "",
             "| driver | renderer, version | pictures | equal | largest FLIP | of | bound |",
             "|---|---|---|---|---|---|---|"]
    with tempfile.TemporaryDirectory() as folder:
        reference = Run.start(REFERENCE, Path(folder)).result()
        if isinstance(reference, str):
            sys.exit(reference)
        for driver in DRIVERS:
            told = Run.start(driver, Path(folder), skipped=driver.slow).result()
            if isinstance(told, str):
                lines.append(f"| {driver.name} | {told} | | | | | |")
                continue
            found = differences(told, reference)
            worst = max(found, key=lambda name: found[name])
            equal = sum(value == 0 for value in found.values())
            lines.append(f"| {driver.name} | {told['renderer']}, {told['version']} | {len(found)} | {equal} | "
                         f"{found[worst]:.5f} | {worst if found[worst] else ''} | {driver.bound} |")
            print(lines[-1], flush=True)
    text = "\n".join(lines) + "\n"
    Path(sys.argv[1]).write_text(text) if len(sys.argv) > 1 else print(text)


if __name__ == "__main__":
    main()
