"""A headless Chromium, told what to do through a pipe (the Chrome DevTools Protocol), as a person would do it."""

from __future__ import annotations

import base64
import json
import os
import select
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from types import TracebackType
from typing import Any, Self

from needs import BROWSERS
from waiting import PATIENCE_S, wait_until

# A browser reads its orders from descriptor 3 and answers on 4.
_START = """
import fcntl, os, sys
reading, writing = (fcntl.fcntl(int(number), fcntl.F_DUPFD, 10) for number in sys.argv[1:3])
os.dup2(reading, 3)
os.dup2(writing, 4)
os.execv(sys.argv[3], sys.argv[3:])
"""


def find_browser() -> str | None:
    return next((path for name in BROWSERS if (path := shutil.which(name))), None)


class Browser:
    """One page of a browser of its own, `width` x `height`. `problems` are the errors its scripts have made so far."""

    def __init__(self, program: str, width: int = 1100, height: int = 900, dark: bool = False) -> None:
        self.problems: list[str] = []
        self._profile = tempfile.TemporaryDirectory(prefix="pbr-viewer-browser-", ignore_cleanup_errors=True)
        reading, to_browser = os.pipe()
        from_browser, writing = os.pipe()
        options = ["--headless", "--no-sandbox", "--disable-gpu", "--no-first-run", "--remote-debugging-pipe",
                   "--disable-dev-shm-usage", f"--user-data-dir={self._profile.name}", "about:blank"]
        start = [sys.executable, "-c", _START, str(reading), str(writing), program, *options]
        self._process = subprocess.Popen(start, pass_fds=(reading, writing), stdout=subprocess.DEVNULL,
                                         stderr=subprocess.DEVNULL)
        os.close(reading)
        os.close(writing)
        self._out, self._in = to_browser, from_browser
        self._buffer, self._number, self._session = b"", 0, None
        target = self._ask("Target.createTarget", url="about:blank")["targetId"]
        self._session = self._ask("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Log"):
            self._ask(f"{domain}.enable")
        self._ask("Browser.grantPermissions", permissions=["clipboardReadWrite", "clipboardSanitizedWrite"])
        self._ask("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=False)
        self._ask("Emulation.setEmulatedMedia",
                  features=[{"name": "prefers-color-scheme", "value": "dark" if dark else "light"}])
        self._ask("Emulation.setFocusEmulationEnabled", enabled=True)

    def open(self, page: Path | str) -> None:
        """A file, or an address."""
        url = page if isinstance(page, str) else page.as_uri()
        self._ask("Page.navigate", url=url)
        self.wait(f"document.readyState === 'complete' && location.protocol === '{url.partition(':')[0]}:'")

    def allow_scripts(self, allowed: bool) -> None:
        """To the pages that are opened from now on."""
        self._ask("Emulation.setScriptExecutionDisabled", value=not allowed)

    def value(self, expression: str) -> Any:
        """What a JavaScript expression, or its promise, comes to."""
        answer = self._ask("Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True)
        if "exceptionDetails" in answer:
            raise AssertionError(answer["exceptionDetails"]["exception"].get("description", expression))
        return answer["result"].get("value")

    def wait(self, expression: str) -> None:
        """Until it is true."""
        wait_until(lambda: self.value(expression), what=expression)

    def place(self, selector: str) -> tuple[float, float, float, float]:
        """Left, top, width and height of an element, once it is scrolled into view."""
        script = ("(e => { e.scrollIntoView({block: 'center'}); const b = e.getBoundingClientRect(); "
                  f"return [b.left, b.top, b.width, b.height] }})(document.querySelector({selector!r}))")
        return tuple(self.value(script))

    def click(self, selector: str) -> None:
        left, top, width, height = self.place(selector)
        self.drag((left + width / 2, top + height / 2))

    def drag(self, *places: tuple[float, float]) -> None:
        """Press the mouse's button at the first place, move through the others, and let it go."""
        self._mouse("mouseMoved", places[0], 0)
        self._mouse("mousePressed", places[0], 1)
        for place in places[1:]:
            self._mouse("mouseMoved", place, 1)
        self._mouse("mouseReleased", places[-1], 0)

    def touch(self, *places: tuple[float, float]) -> None:
        """As `drag`, by a finger."""
        for number, (x, y) in enumerate(places):
            self._ask("Input.dispatchTouchEvent", type="touchMove" if number else "touchStart",
                      touchPoints=[{"x": x, "y": y}])
        self._ask("Input.dispatchTouchEvent", type="touchEnd", touchPoints=[])

    def pinch(self, middle: tuple[float, float], *apart: float) -> None:
        """Two fingers beside each other, so many pixels apart, one after the other."""
        for number, distance in enumerate(apart):
            points = [{"x": middle[0] + side * distance / 2, "y": middle[1], "id": side} for side in (-1, 1)]
            self._ask("Input.dispatchTouchEvent", type="touchMove" if number else "touchStart", touchPoints=points)
        self._ask("Input.dispatchTouchEvent", type="touchEnd", touchPoints=[])

    def wheel(self, place: tuple[float, float], dy: float) -> None:
        """Turn the wheel by so many pixels, downwards."""
        self._ask("Input.dispatchMouseEvent", type="mouseWheel", x=place[0], y=place[1], deltaX=0, deltaY=dy)

    def hover(self, selector: str) -> None:
        left, top, width, height = self.place(selector)
        self._mouse("mouseMoved", (left + width / 2, top + height / 2), 0)

    def _mouse(self, kind: str, place: tuple[float, float], buttons: int) -> None:
        button = "none" if kind == "mouseMoved" and not buttons else "left"
        self._ask("Input.dispatchMouseEvent", type=kind, x=place[0], y=place[1], button=button, buttons=buttons,
                  clickCount=int(kind != "mouseMoved"))

    def press(self, key: str) -> None:
        codes = {"ArrowLeft": 37, "ArrowUp": 38, "ArrowRight": 39, "ArrowDown": 40, "End": 35, "Home": 36}
        for kind in ("keyDown", "keyUp"):
            self._ask("Input.dispatchKeyEvent", type=kind, key=key, code=key, windowsVirtualKeyCode=codes[key])

    def strike(self, letter: str) -> None:
        """Press the key of a small letter or a digit."""
        code = f"Digit{letter}" if letter.isdigit() else f"Key{letter.upper()}"
        for kind in ("keyDown", "keyUp"):
            self._ask("Input.dispatchKeyEvent", type=kind, key=letter, code=code,
                      windowsVirtualKeyCode=ord(letter.upper()))

    def run_cell(self) -> None:
        """Press Shift and Enter, for the cell of a notebook that has the focus."""
        for kind in ("keyDown", "keyUp"):
            self._ask("Input.dispatchKeyEvent", type=kind, key="Enter", code="Enter", windowsVirtualKeyCode=13,
                      modifiers=8)

    def shot(self, file: Path) -> None:
        """A picture of what is seen of the page. One of the whole page would resize it for a moment."""
        data = self._ask("Page.captureScreenshot")["data"]
        file.write_bytes(base64.b64decode(data))

    def _ask(self, method: str, **parameters: Any) -> dict[str, Any]:
        self._number += 1
        message = {"id": self._number, "method": method, "params": parameters}
        if self._session is not None and not method.startswith(("Target", "Browser")):
            message["sessionId"] = self._session
        os.write(self._out, json.dumps(message).encode() + b"\0")
        while True:
            answer = self._next_message()
            if answer.get("id") == self._number:
                assert "error" not in answer, answer["error"]
                return answer["result"]
            self._note(answer)

    def _note(self, event: dict[str, Any]) -> None:
        parameters = event.get("params", {})
        if event.get("method") == "Runtime.exceptionThrown":
            details = parameters["exceptionDetails"]
            self.problems.append(details.get("exception", {}).get("description") or details["text"])
        if event.get("method") == "Log.entryAdded" and parameters["entry"]["level"] == "error":
            self.problems.append(parameters["entry"]["text"])

    def _next_message(self) -> dict[str, Any]:
        while b"\0" not in self._buffer:
            ready, _, _ = select.select([self._in], [], [], PATIENCE_S)
            more = os.read(self._in, 1 << 16) if ready else b""
            assert more, "the browser has gone or says nothing"
            self._buffer += more
        message, _, self._buffer = self._buffer.partition(b"\0")
        return json.loads(message)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None,
                 trace: TracebackType | None) -> None:
        self._process.terminate()
        self._process.wait()
        os.close(self._out)
        os.close(self._in)
        self._profile.cleanup()
