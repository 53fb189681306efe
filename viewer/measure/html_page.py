"""Pages that stand alone: all they need is in them, and they suit a screen of any width, bright or dark."""

from __future__ import annotations

import html
from pathlib import Path

_STYLE = Path(__file__).resolve().parent / "html_page.css"
_PAGE = """<!doctype html>
<html lang="en">
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="color-scheme" content="light dark">
<title>{title}</title>
<style>
{style}</style>
{body}
</html>
"""


def html_page(title: str, body: str, style: str) -> str:
    """A page of `body`, HTML; `title` is text, `style` CSS beside what all pages have."""
    return _PAGE.format(title=html.escape(title), style=_STYLE.read_text(encoding="utf-8") + style, body=body)
