"""The progress bar: on a terminal alone, after a while, and gone at the end."""

from __future__ import annotations

import os
import subprocess
import sys

from needs import needs

pytestmark = needs("posix")
# What the terminal can do: the environment of the tests may say that it can do nothing (TERM=dumb, NO_COLOR, CI).
TERMINAL = {name: value for name, value in os.environ.items() if name in ("PATH", "HOME", "PYTHONPATH", "VIRTUAL_ENV")}
TERMINAL |= {"TERM": "xterm", "COLUMNS": "100", "LINES": "25", "PYTHONIOENCODING": "utf-8"}
START = "import sys, time, viewer.base.progress as p\n"


def on_terminal(code: str, **environment: str) -> bytes:
    """What Python code writes to stderr when that is a terminal."""
    import pty  # Windows has none

    terminal, end = pty.openpty()
    process = subprocess.Popen([sys.executable, "-c", START + code], stderr=end, stdout=subprocess.PIPE,
                               env=TERMINAL | environment)
    os.close(end)
    shown = b""
    while True:
        try:
            piece = os.read(terminal, 4096)
        except OSError:  # the other end is closed
            break
        if not piece:
            break
        shown += piece
    os.close(terminal)
    out, _ = process.communicate()
    assert (process.returncode, out) == (0, b"")
    return shown


UNTIL_SHOWN = "while not bar.is_shown: time.sleep(0.01)"
LONG = """p.DELAY_S = 0.05
with p.Progress(2) as bar:
    bar.step("one [b]")
    time.sleep(0.2)
    print("a warning", file=sys.stderr)
    bar.step("t\x1bwo")
"""


def test_what_takes_long_shows_a_bar_that_goes_again():
    shown = on_terminal(LONG.replace("time.sleep(0.2)", UNTIL_SHOWN))
    assert b"one [b]" in shown and b"0/2" in shown and b"1/2" in shown and b"t\\x1bwo" in shown
    assert b"a warning\r\n" in shown
    assert shown.endswith(b"\x1b[2K")  # the line is erased


def test_a_terminal_that_cannot_move_its_cursor_gets_no_bar():
    assert on_terminal(LONG, TERM="dumb") == b"a warning\r\n"


def test_a_part_of_a_piece_moves_the_bar_and_not_the_count():
    shown = on_terminal(f"""p.DELAY_S = 0.05
with p.Progress(1) as bar:
    bar.step("one")
    {UNTIL_SHOWN}
    bar.part(1.0, "nearly")
""")
    assert b"nearly" in shown and b"0/1" in shown and b"1/1" not in shown


def test_pieces_that_are_done_at_once_are_counted_with_their_rate():
    shown = on_terminal(f"""p.DELAY_S = 0.05
with p.Progress(3, unit="models") as bar:
    {UNTIL_SHOWN}
    bar.done(2, "two")
""")
    assert b"2/3" in shown and b"two" in shown and b" models a minute" in shown


def test_what_is_short_or_quiet_shows_nothing():
    assert on_terminal('with p.Progress(2) as bar: bar.step("one")') == b""
    assert on_terminal(LONG.replace("Progress(2)", "Progress(2, enabled=False)")) == b"a warning\r\n"


def test_without_a_terminal_there_is_none():
    for code in (LONG, "sys.stderr = None\n" + LONG.replace("    print(", "    0 and print(")):
        process = subprocess.run([sys.executable, "-c", START + code], capture_output=True)
        assert process.returncode == 0 and process.stdout == b"" and b"one" not in process.stderr
