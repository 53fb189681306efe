"""`pbr-viewer serve`: who gets in, what they get, and how they steer; by sockets and by a real browser."""

from __future__ import annotations

import asyncio
import http.client
import io
import json
import math
import re
import signal
import socket
import subprocess
import sys
import threading
from collections.abc import Iterator
from typing import Any, cast
from urllib.parse import urlsplit

import numpy as np
import pytest
from browser import Browser, find_browser
from command_line import SCENES
from needs import needs
from PIL import Image as Pillow
from waiting import PATIENCE_S, wait_until

import viewer
from viewer.gpu.context import open_context
from viewer.settings import Settings
from viewer.web.audience import SHOWN, Audience
from viewer.web.view import RemoteView

pytestmark = needs("serve")
MODEL = SCENES / "spheres.glb"
SIZE = (96, 64)
PLAIN = Settings(background=(0.2, 0.2, 0.2), denoise="off")


class Running:
    """A server on a thread of its own, where its OpenGL is, too."""

    def __init__(self) -> None:
        self.address, self.error = "", None
        self._ends = False
        self._ready = threading.Event()
        self._thread = threading.Thread(target=self._run)
        self._thread.start()
        assert self._ready.wait(PATIENCE_S) and self.error is None

    def _run(self) -> None:
        from viewer.web.server import ViewServer, listen

        self.scene = viewer.load(MODEL)
        self.view = RemoteView(open_context, self.scene, PLAIN, most=SIZE)
        try:
            server = ViewServer(self.view)
            self.audience = server.audience
            with listen("127.0.0.1", 0) as listener:
                asyncio.run(server.run(listener, self._announce, lambda: self._ends))
        except Exception as error:
            self.error = error
            raise
        finally:
            self.view.sleep()
            self._ready.set()

    def _announce(self, address: str) -> None:
        self.address = address
        self._ready.set()

    def stop(self) -> None:
        self._ends = True
        self._thread.join(PATIENCE_S)
        assert not self._thread.is_alive() and self.error is None

    def get(self, path: str, **headers: str) -> http.client.HTTPResponse:
        connection = http.client.HTTPConnection(urlsplit(self.address).netloc, timeout=PATIENCE_S)
        connection.request("GET", path, headers=headers)
        return connection.getresponse()

    @property
    def path(self) -> str:
        return urlsplit(self.address).path


@pytest.fixture(scope="module")
def server() -> Iterator[Running]:
    server = Running()
    yield server
    server.stop()


class Guest:
    """A client without a browser: what it is told, and the picture that it got last."""

    def __init__(self, server: Running, size: tuple[int, int] = SIZE) -> None:
        from websockets.sync.client import connect

        opened = connect(f"{server.address.replace('http', 'ws')}view", max_size=None,
                         origin=f"http://{urlsplit(server.address).netloc}", proxy=None)
        self.socket = opened.__enter__()
        self.words: dict[str, Any] = {}
        self.picture = b""
        self.size = size
        self.send(kind="size", width=size[0], height=size[1])

    def send(self, **message: Any) -> None:
        self.socket.send(json.dumps(message))

    def take(self) -> None:
        """The next that it is sent."""
        self.words = json.loads(self.socket.recv(PATIENCE_S))
        if self.words["hasPicture"]:
            self.picture = self.socket.recv(PATIENCE_S)

    def rest(self) -> np.ndarray:
        """The next picture at rest."""
        self.sizes_until_rest()
        return self.pixels

    def sizes_until_rest(self) -> list[tuple[int, int]]:
        """Those of all pictures up to the next one at rest, which alone is sent without loss."""
        sizes, self.picture = [], b""
        while not self.picture.startswith(b"\x89PNG"):
            self.take()
            self.send(kind="shown")
            sizes += [Pillow.open(io.BytesIO(self.picture)).size] if self.words["hasPicture"] else []
        return sizes

    @property
    def pixels(self) -> np.ndarray:
        return np.asarray(Pillow.open(io.BytesIO(self.picture)).convert("RGB")).astype(int)

    def mouse(self, kind: str, x: float, y: float, **more: Any) -> None:
        flags = {} if kind == "move" else {"is_left": True, "shift": False}
        self.send(kind=kind, x=x, y=y, width=self.size[0], height=self.size[1], **(flags | more))

    def drag(self, dx: float, dy: float) -> None:
        x, y = self.size[0] / 2, self.size[1] / 2
        self.mouse("press", x, y)
        self.mouse("move", x + dx, y + dy)
        self.mouse("release", x + dx, y + dy)

    def key(self, name: str) -> None:
        self.send(kind="key", key=name)


@pytest.fixture
def guest(server) -> Iterator[Guest]:
    guest = Guest(server)
    guest.rest()
    guest.key("V")
    guest.key("F")
    yield guest
    guest.key("1")
    guest.socket.close()
    wait_until(lambda: server.audience.is_empty)


def right(server: Running, **changes: Any) -> np.ndarray:
    """What `render` makes of the view as it is."""
    camera = server.view.orbit.camera
    return viewer.render(server.scene, server.view.size, camera, **(vars(PLAIN) | changes)).srgb[..., :3].astype(int)


def apart(a: np.ndarray, b: np.ndarray) -> float:
    return float(np.abs(a - b).mean()) if a.shape == b.shape else 255.0


@pytest.mark.parametrize("path", ["/", "/view", "/favicon.ico", "/wrong/", "/wrong/view", "//", "/../etc/passwd",
                                  "/%2e%2e/", "/{short}/", "/{long}/", "/{upper}/", "/é/"])
def test_without_the_token_nobody_gets_in(server, path):
    token = server.path.strip("/")
    path = path.format(short=token[:-1], long=token + "x", upper=token.swapcase())
    answer = server.get(path.encode().decode("latin-1") if path.isascii() else "/%C3%A9/")
    body = answer.read()
    assert answer.status == 403 and token.encode() not in body and b"<script>" not in body


@pytest.mark.parametrize("path", ["index.html", "view.js", "../view.js", "%2e%2e/server.py", "..%2fserver.py",
                                  "/etc/passwd", "view/", "viewx", "..\\server.py"])
def test_nothing_but_the_page_and_the_socket_is_served(server, path):
    answer = server.get(server.path + path)
    assert answer.status == 404 and answer.read() == b"There is nothing here.\n"


def test_the_page_is_kept_by_nobody_and_tells_nobody_its_address(server):
    for path in (server.path, server.path.rstrip("/"), server.path + "?x=1"):
        answer = server.get(path)
        page = answer.read().decode()
        assert answer.status == 200 and "<title>spheres</title>" in page
        assert server.path.strip("/") not in page and "://" not in page.replace("data:", "")
    headers = dict(answer.getheaders())
    assert headers["Cache-Control"] == "no-store" and headers["Referrer-Policy"] == "no-referrer"
    assert "frame-ancestors 'none'" in headers["Content-Security-Policy"] and "Server" not in headers


@pytest.mark.parametrize("origin", [None, "http://evil.example", "null", "http://{host}.evil.example", "ftp://{host}"])
def test_another_sites_page_cannot_connect_even_with_the_token(server, origin):
    from websockets.exceptions import InvalidStatus
    from websockets.sync.client import connect

    host = urlsplit(server.address).netloc
    origin = origin and origin.format(host=host)
    with (pytest.raises(InvalidStatus) as refused,
          connect(f"{server.address.replace('http', 'ws')}view", origin=origin, proxy=None)):
        pass
    assert refused.value.response.status_code == 403
    with (pytest.raises(InvalidStatus) as refused,
          connect(f"ws://{host}/wrong/view", origin=f"http://{host}", proxy=None)):
        pass
    assert refused.value.response.status_code == 403


def test_at_rest_it_shows_what_render_makes(server, guest):
    assert apart(guest.rest(), right(server)) < 0.5
    for key, mode in [("2", "phong"), ("1", "pbr")]:
        guest.key(key)
        assert apart(guest.rest(), right(server, mode=mode)) < 0.5


def test_a_drag_turns_the_model_as_in_the_window(server, guest):
    before, azimuth = guest.rest(), server.view.orbit.azimuth
    guest.drag(SIZE[1] / 4, 0)
    turned = guest.rest()
    assert server.view.orbit.azimuth == pytest.approx(azimuth - np.pi / 4)
    assert apart(turned, right(server)) < 0.5 < apart(turned, before)
    distance = server.view.orbit.distance
    guest.mouse("wheel", SIZE[0] / 2, SIZE[1] / 2, dx=0, dy=2)
    guest.rest()
    assert server.view.orbit.distance < distance


def test_a_picture_that_moves_too_slowly_is_smaller_until_it_rests(server, guest, monkeypatch):
    monkeypatch.setattr("viewer.interact.pace.FRAME_SECONDS", 1e-6)
    for dx in (10, 20):  # the first tells how slow it is
        guest.drag(dx, 0)
        sizes = guest.sizes_until_rest()
        assert sizes[-1] == SIZE
    smaller = round(SIZE[0] / 8**0.5), round(SIZE[1] / 8**0.5)
    assert set(sizes) == {smaller, SIZE}
    assert apart(guest.pixels, right(server)) < 0.5
    guest.key("2")
    assert set(guest.sizes_until_rest()) == {SIZE}  # nothing moves


def test_a_split_and_its_line(server, guest):
    guest.key("3")
    guest.rest()
    assert guest.words["split"] == 0.5 and guest.words["sides"] == ["phong", "pbr"]
    azimuth = server.view.orbit.azimuth
    guest.drag(-SIZE[0] / 4, 0)
    guest.rest()
    assert guest.words["split"] == pytest.approx(0.25) and server.view.orbit.azimuth == azimuth


def test_paths_are_traced_at_rest(server, guest):
    guest.rest()
    guest.key("8")
    while "samples a pixel" not in guest.words["status"]:
        guest.take()
        guest.send(kind="shown")
    assert guest.words["message"] == ""


def test_two_look_at_one_view_and_one_that_vanishes_holds_nobody_up(server, guest):
    guest.rest()
    other = Guest(server, (40, 60))
    assert other.rest().shape == (60, 40, 3)  # in the shape of the one who came last
    other.drag(10, 0)
    assert guest.rest().shape == (60, 40, 3)
    other.socket.socket.shutdown(socket.SHUT_RDWR)  # without a word, and with a picture on its way
    guest.drag(10, 5)
    picture = guest.rest()
    assert picture.shape == (*SIZE[::-1], 3) and apart(picture, right(server)) < 0.5


def test_nothing_piles_up_for_one_who_says_that_all_was_shown_but_reads_nothing(server, monkeypatch):
    from viewer.web.server import ViewServer

    monkeypatch.setattr("viewer.web.audience.LOOK_SECONDS", 0.02)

    class Deaf:
        sent = 0

        async def send(self, data: str | bytes) -> None:
            self.sent += 1
            await asyncio.Event().wait()

        async def __aiter__(self):
            yield json.dumps({"kind": "size", "width": 8, "height": 8})
            while True:
                await asyncio.sleep(0.005)
                yield json.dumps(SHOWN)

    class Moving:
        version, seconds_until_work, seconds_until_rest = 0, 0.0, 1.0

        def step(self) -> None:
            self.version += 1

        words, encoded = (lambda self: {}), (lambda self, lossless: b"")
        handle = forget = lambda self, *_: None

    async def attend() -> int:
        one, deaf, looks = ViewServer(server.view), Deaf(), iter(range(10))
        one.audience = Audience(cast(RemoteView, Moving()))
        listening = asyncio.create_task(one._attend(cast(Any, deaf)))
        await one.audience.attend(lambda: next(looks) == 9)
        listening.cancel()
        return deaf.sent

    assert asyncio.run(attend()) == 1


def test_one_who_sends_anything_else_is_shown_out(server, guest):
    from websockets.exceptions import ConnectionClosed

    for text in ("{", "[]", '{"kind": "open"}', "\udcff", "[" * 3000, '{"kind": "size", "width": NaN, "height": 3}'):
        stranger = Guest(server)
        stranger.socket.send(text.encode("utf-8", "surrogateescape"), text=False)
        with pytest.raises(ConnectionClosed) as closed:
            while True:
                stranger.take()
        assert closed.value.rcvd is not None and closed.value.rcvd.code == 1008, text
    guest.drag(5, 5)
    guest.rest()


@needs("chromium")
def test_in_a_browser(server, tmp_path, caplog, capfd):
    orbit = server.view.orbit
    with Browser(find_browser(), 300, 200) as page:
        page.open(server.address)
        page.wait("document.querySelector('canvas').width > 0")
        wait_until(lambda: server.view.size == SIZE)

        def pixels() -> np.ndarray:
            page.shot(tmp_path / "shot.png")
            return np.asarray(Pillow.open(tmp_path / "shot.png").convert("RGB")).astype(int)

        def has_turned(angle: float) -> bool:
            return abs(math.remainder(azimuth - orbit.azimuth - angle, 2 * math.pi)) < 1e-6

        wait_until(lambda: server.view.seconds_until_rest == 0)
        before, azimuth = pixels(), orbit.azimuth
        page.drag((150, 100), (160, 100), (200, 100))
        wait_until(lambda: has_turned(math.pi / 4))
        wait_until(lambda: apart(pixels(), before) > 1)
        page.touch((150, 100), (160, 100), (200, 100))
        wait_until(lambda: has_turned(math.pi / 2))
        page._mouse("mousePressed", (150, 100), 1)
        wait_until(lambda: any(pointer.is_dragging for pointer in server.view._pointers.values()))
        other = Guest(server, (64, 64))  # in the middle of a drag the picture gets another shape
        page.wait("(c => c.width === c.height)(document.querySelector('canvas'))")
        page._mouse("mouseMoved", (200, 100), 1)
        page._mouse("mouseReleased", (200, 100), 0)
        wait_until(lambda: has_turned(3 * math.pi / 4))
        other.socket.close()
        distance = orbit.distance
        page.wheel((150, 100), -200)  # two notches away from the user
        wait_until(lambda: orbit.distance == pytest.approx(0.88**2 * distance))
        page.pinch((150, 100), 40, 80)
        wait_until(lambda: orbit.distance == pytest.approx(0.88**2 * distance / 2))
        page.strike("f")
        wait_until(lambda: orbit.distance > 0.9 * distance)
        target = orbit.target
        wait_until(lambda: (orbit.target != target).any(),  # two clicks of a busy machine may be too far apart
                   lambda: (page.drag((130, 90)), page.drag((130, 90))))
        page.strike("3")
        page.wait("!document.querySelector('.line').hidden")
        assert page.value("document.querySelector('.side.left').textContent") == "phong"
        page.strike("h")
        assert "Three-quarter view" in page.value("document.querySelector('.help').innerText")
        assert "Drop a file" not in page.value("document.querySelector('.help').textContent")
        page.strike("h")
        page.strike("2")
        page.wait("document.querySelector('.line').hidden")
        assert server.view.state.settings.mode == "phong"
        page.value("fetch('https://example.com/').catch(() => 0)")
        assert page.problems and all("violates the" in problem for problem in page.problems)  # its security policy
    wait_until(lambda: server.audience.is_empty)
    told = capfd.readouterr()
    assert server.path.strip("/") not in caplog.text + told.out + told.err


@pytest.fixture
def busy_port() -> Iterator[int]:
    with socket.socket() as other:
        other.bind(("127.0.0.1", 0))
        other.listen()
        yield other.getsockname()[1]


def test_a_port_in_use_and_a_strange_host_are_one_line(run, busy_port):
    outcome = run("serve", MODEL, "--port", busy_port)
    assert outcome.status == 1 and outcome.error == (
        f"port {busy_port} of 127.0.0.1 is in use; choose another by --port, or --port 0 for any that is free")
    outcome = run("serve", MODEL, "--host", "203.0.113.7", "--port", "0")
    assert outcome.status == 2 and outcome.error == "--host 203.0.113.7: is no address of this machine"


def test_without_its_package_it_names_the_extra(run, monkeypatch):
    monkeypatch.setattr("viewer.web.serve_job.find_spec", lambda name: None)
    assert "pip install 'pbr-viewer[serve]'" in run("serve", MODEL).error


@needs("posix")
def test_ctrl_c_ends_it_and_an_open_host_is_warned_of():
    command = [sys.executable, "-m", "viewer", "serve", str(MODEL), "--port", "0", "--size", "64", "--host", "0.0.0.0"]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    address = process.stdout.readline().strip()
    found = re.fullmatch(r"http://[^/:]+:(\d+)/[\w-]{32}/", address)
    assert found is not None, address
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=PATIENCE_S)
    assert (process.returncode, out) == (0, "")
    lines = err.splitlines()
    assert len(lines) == 2 and lines[0].startswith("warning: --host 0.0.0.0 opens this port to all who can reach")
    assert lines[1] == "Ctrl-C ends it" and urlsplit(address).path.strip("/") not in err
