"""The page that shows golden images that failed, side by side with what was drawn."""

from __future__ import annotations

import base64
import html
import json
import shutil
from pathlib import Path

from ...base.atomic import atomic_write
from ...base.counted import counted
from ..html_page import html_page

_STYLE = """
section { border-top: 1px solid var(--line); padding: 1rem 0 }
h2 { font-size: 1rem; margin: 0; overflow-wrap: anywhere } p { color: #d22 }
div { display: flex; flex-wrap: wrap; gap: 1rem }
img { image-rendering: pixelated; min-width: 12rem; max-width: 30vw;
  background: repeating-conic-gradient(#ddd 0 25%, #fff 0 50%) 0 0 / 16px 16px }
"""
_CAPTIONS = {"expected": "expected", "actual": "actual", "difference": "FLIP (black: equal)"}


def clear_report(folder: Path) -> None:
    """Removes what an earlier session wrote there, and nothing else."""
    for facts in folder.glob("*/failure.json"):
        shutil.rmtree(facts.parent, ignore_errors=True)
    (folder / "index.html").unlink(missing_ok=True)


def write_report(folder: Path) -> Path | None:
    """Gathers the failures written below `folder` into one page that stands alone; None where there are none."""
    failures = sorted(folder.glob("*/failure.json"))
    if not failures:
        return None
    title = f"{counted(len(failures), 'golden image')} failed"
    with atomic_write(folder / "index.html") as file:
        body = "\n".join([f"<h1>{title}</h1>", *map(_section, failures)])
        file.write_text(html_page(title, body, _STYLE), encoding="utf-8")
    return folder / "index.html"


def _section(facts: Path) -> str:
    values = {name: html.escape(text) for name, text in json.loads(facts.read_text()).items()}
    figures = []
    for name, caption in _CAPTIONS.items():
        picture = facts.with_name(f"{name}.png")
        if picture.exists():
            data = base64.b64encode(picture.read_bytes()).decode()
            figures.append(f'<figure><img alt="{name}" src="data:image/png;base64,{data}">'
                           f"<figcaption>{caption}</figcaption></figure>")
    return (f"<section><h2>{values['test']}</h2>{values['golden']}<p>{values['problem']}</p>"
            f"<div>{''.join(figures)}</div></section>")
