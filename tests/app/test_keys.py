"""The table of keys, and what is made from it."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

import pytest

from viewer.interact.keys import KEYS, action_of, help_groups, label, markdown

DOCS = Path(__file__).parents[2] / "docs" / "window.md"


def test_no_key_means_two_things():
    counts = Counter(key for binding in KEYS for key in binding.keys)
    assert [key for key, count in counts.items() if count > 1] == []


@pytest.mark.parametrize("key, shift, control, action", [
    ("1", False, False, "pbr"), ("Z", False, False, "view_front"), ("Z", True, False, "view_back"),
    ("KP_7", False, True, "view_bottom"), ("S", False, True, "screenshot"), ("S", True, True, None),
    ("", False, False, None),
])
def test_what_a_key_does(key, shift, control, action):
    assert action_of(key, shift, control) == action


def test_labels_are_what_people_call_them():
    assert [label(key) for key in ("Ctrl+KP_7", "ESCAPE", "F12", "Shift+Z")] == ["Ctrl+Num 7", "Esc", "F12", "Shift+Z"]


def test_help_has_every_binding():
    lines = [text for _, lines in help_groups() for _, text in lines]
    assert set(lines) >= {binding.text for binding in KEYS}


def test_documentation_is_in_step():
    text = DOCS.read_text(encoding="utf-8")
    start, end = "<!-- keys: made by viewer.interact.keys.markdown() -->\n", "<!-- end of keys -->"
    assert text[text.index(start) + len(start):text.index(end)].strip() == markdown().strip()


def test_every_key_has_a_code_of_glfws():
    from viewer.app.input import _NAMES

    assert {key.split("+")[-1] for binding in KEYS for key in binding.keys} <= set(_NAMES.values())
