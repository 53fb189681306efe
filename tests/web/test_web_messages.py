"""What a browser may send: only what our page sends gets through."""

from __future__ import annotations

import json

import pytest

from viewer.web.messages import BadMessage, Message, message_of

MOVE = {"kind": "move", "x": 3, "y": 4.5, "width": 320, "height": 200}


@pytest.mark.parametrize("content, message", [
    (MOVE, Message("move", 3.0, 4.5, 320.0, 200.0)),
    ({"kind": "size", "width": 1, "height": 2}, Message("size", width=1.0, height=2.0)),
    (MOVE | {"kind": "press", "is_left": False, "shift": True},
     Message("press", 3.0, 4.5, 320.0, 200.0, is_left=False, shift=True)),
    (MOVE | {"kind": "wheel", "dx": 0, "dy": -1.5, "shift": False},
     Message("wheel", 3.0, 4.5, 320.0, 200.0, dy=-1.5)),
    ({"kind": "key", "key": "Shift+E"}, Message("key", key="Shift+E")),
    ({"kind": "cancel", "more": "is ignored"}, Message("cancel")),
])
def test_what_our_page_sends_is_understood(content, message):
    assert message_of(content) == message


@pytest.mark.parametrize("text", [
    "null", "[]", '"move"', "{}", '{"kind": "open"}', '{"kind": ["move"]}', '{"kind": "move"}',
    json.dumps(MOVE | {"x": "3"}), json.dumps(MOVE | {"x": True}), json.dumps(MOVE | {"x": None}),
    json.dumps(MOVE | {"x": float("nan")}), json.dumps(MOVE | {"y": float("-inf")}), json.dumps(MOVE | {"y": 10**400}),
    json.dumps(MOVE | {"width": 0}), json.dumps(MOVE | {"height": -5}), json.dumps(MOVE | {"width": 1e9}),
    json.dumps(MOVE | {"kind": "press", "is_left": 1, "shift": False}),
    json.dumps(MOVE | {"kind": "wheel", "dx": 0, "dy": 1e4, "shift": False}),
    '{"kind": "key"}', '{"kind": "key", "key": 8}', json.dumps({"kind": "key", "key": "x" * 33}),
    '{"kind": "size", "width": 0.2, "height": 5}',
])
def test_anything_else_is_refused(text):
    with pytest.raises(BadMessage):
        message_of(json.loads(text))
