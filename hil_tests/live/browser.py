"""A headless Chromium that a test drives by its DevTools protocol (Chrome DevTools Protocol, 1.3)."""

import base64
import json
import shutil
import subprocess
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from types import MappingProxyType
from typing import Any, Final
from urllib.request import urlopen

import pytest
from websockets.sync.client import ClientConnection, connect

from firmware_bridge.runtime.clock import Clock
from firmware_bridge.units import MILLISECOND
from hil_tests.lanes import HUNG_S

NAMES: Final = ("chromium", "chromium-browser", "google-chrome")
CODES: Final[Mapping[str, tuple[str, int]]] = MappingProxyType(
    {"w": ("KeyW", 87), "Escape": ("Escape", 27), " ": ("Space", 32)}
)


class Browser:
    """One page."""

    def __init__(self, connection: ClientConnection) -> None:
        self._connection: Final = connection
        self._count = 0
        self.errors: Final[list[str]] = []
        """Exceptions of the page, and what its policy has refused."""
        for domain in ("Runtime", "Log", "Page"):
            self.command(f"{domain}.enable")

    def command(self, method: str, **params: Any) -> dict[str, Any]:
        """Send a command; return its result."""
        self._count += 1
        self._connection.send(json.dumps({"id": self._count, "method": method, "params": params}))
        while True:
            message = json.loads(self._connection.recv(timeout=HUNG_S))
            if message.get("id") == self._count:
                assert "error" not in message, message
                result: dict[str, Any] = message["result"]
                return result
            self._note(message)

    def opens(self, address: str, width: int, height: int) -> None:
        """Go to a page in a window of this size."""
        self.resizes(width, height)
        self.command("Page.navigate", url=address)
        self.waits("typeof known !== 'undefined' && known.state")

    def resizes(self, width: int, height: int) -> None:
        """Change the window's size."""
        size = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": False}
        self.command("Emulation.setDeviceMetricsOverride", **size)

    def value(self, expression: str) -> Any:
        """Return the value of an expression in the page."""
        found = self.command("Runtime.evaluate", expression=expression, returnByValue=True)
        assert "exceptionDetails" not in found, (expression, found)
        return found["result"].get("value")

    def waits(self, expression: str) -> None:
        """Wait until an expression is true in the page."""
        begun = time.monotonic()
        while not self.value(f"Boolean({expression})"):
            if time.monotonic() - begun > HUNG_S:
                pytest.fail(f"not within {HUNG_S:g} s: {expression}")
            self.rests()

    def clicks(self, identifier: str) -> None:
        """Press a button by its id, where it can be seen and pressed."""
        there = f"(e => e && !e.disabled && e.offsetParent !== null)(document.getElementById('{identifier}'))"
        self.waits(there)
        self.value(f"document.getElementById('{identifier}').click()")

    def key(self, name: str, *, down: bool) -> None:
        """Press a key, or let it go."""
        code, number = CODES[name]
        keys = {"key": name, "code": code, "windowsVirtualKeyCode": number}
        self.command("Input.dispatchKeyEvent", type="keyDown" if down else "keyUp", **keys)

    def rests(self) -> None:
        """Let the page do something."""
        clock = Clock()
        clock.wait((), clock.now() + 50 * MILLISECOND)

    def screenshot(self, path: Path) -> None:
        """Keep what the window shows as a PNG."""
        path.write_bytes(base64.b64decode(self.command("Page.captureScreenshot", format="png")["data"]))

    def _note(self, message: dict[str, Any]) -> None:
        params = message.get("params", {})
        if message.get("method") == "Runtime.exceptionThrown":
            self.errors.append(str(params["exceptionDetails"]))
        entry = params.get("entry", {})
        # What draws the plots may be missing in a checkout without npm, and a program may have ended.
        missing = entry.get("source") == "network" or "uplot" in f"{entry.get('url')} {entry.get('text')}"
        if entry.get("level") == "error" and not missing:
            self.errors.append(str(entry))


@contextmanager
def browser(folder: Path) -> Iterator[Browser]:
    """Start a browser with a profile of its own; end it with the test."""
    program = next(filter(None, map(shutil.which, NAMES)), None)
    assert program is not None, f"one of {', '.join(NAMES)} is needed: .ci/packages nightly"
    words = ["--headless", "--no-sandbox", "--disable-gpu", "--remote-debugging-port=0", "--mute-audio"]
    process = subprocess.Popen(
        [program, *words, f"--user-data-dir={folder}"], stderr=subprocess.DEVNULL, stdout=subprocess.DEVNULL
    )
    try:
        port = _port(folder / "DevToolsActivePort")
        with urlopen(f"http://127.0.0.1:{port}/json") as answer:
            pages = [one for one in json.load(answer) if one["type"] == "page"]
        with connect(pages[0]["webSocketDebuggerUrl"], max_size=None, open_timeout=HUNG_S) as connection:
            yield Browser(connection)
    finally:
        process.kill()
        process.wait()


def _port(file: Path) -> int:
    begun, clock = time.monotonic(), Clock()
    while not (file.exists() and file.read_text().strip()):
        assert time.monotonic() - begun < HUNG_S, "the browser has not started"
        clock.wait((), clock.now() + 50 * MILLISECOND)
    return int(file.read_text().split()[0])
