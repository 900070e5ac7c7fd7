# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The live page as a browser shows it: `python -m tools.docs.pictures.monitor FILE [PROJECT]`.

Runs the motor bench, or examples/paper, with its Bluetooth on a port, `ravenbrick monitor --page`
on it, and headless Chromium on the page; drags the slider of the set-point; writes the picture as
PNG. Prints the parameters that the program then has. Needs Debian's chromium-headless-shell and the
example's image.
"""

from __future__ import annotations

import asyncio
import base64
import json
import re
import shutil
import socket
import subprocess
import sys
import tempfile
import urllib.request
from contextlib import ExitStack
from pathlib import Path
from typing import IO, Any

from tornado.websocket import WebSocketClientConnection, websocket_connect

ROOT = Path(__file__).resolve().parents[3]
# Where the lowest slider is clicked, in parts of its width: 3 V
CHROMIUM = "chromium-headless-shell"
SET_POINTS = {"motor-bench": 0.8, "paper": 1 / 3}
RAVENBRICK = [sys.executable, "-c", "from ravenbrick.cli import main; main()"]
WIDTH, HEIGHT = 1040, 800
SECONDS = 45
PATIENCE_S = 90
ADDRESS = re.compile(r"http://127\.0\.0\.1:\d+/[\w-]+/")
# Of the lowest slider in the page: the figure begins at 21, 44; axes of window.py in parts of it
SLIDER_Y = 44 + 700 * (1 - 0.035)
SLIDER_X = 21 + 1000 * 0.2
SLIDER_WIDTH = 1000 * 0.6


def free_port() -> int:
    """A port of this computer that nobody uses."""
    with socket.create_server(("127.0.0.1", 0)) as server:
        return int(server.getsockname()[1])


class Browser:
    """A page of Chromium, steered by its developer tools' protocol."""

    def __init__(self, connection: WebSocketClientConnection) -> None:
        self._connection, self._number = connection, 0

    async def call(self, method: str, **parameters: Any) -> dict[str, Any]:
        """A command and its result."""
        self._number += 1
        message = {"id": self._number, "method": method, "params": parameters}
        await self._connection.write_message(json.dumps(message))
        while True:
            text = await self._connection.read_message()
            if text is None:
                raise ConnectionError("the browser has gone")
            answer: dict[str, Any] = json.loads(text)
            if answer.get("id") == self._number:
                if "error" in answer:
                    raise RuntimeError(answer["error"]["message"])
                return dict(answer["result"])

    async def mouse(self, kind: str, x: float, y: float) -> None:
        """Move, press or release at a place of the page."""
        button = "none" if kind == "mouseMoved" else "left"
        await self.call(
            "Input.dispatchMouseEvent", type=kind, x=x, y=y, button=button, clickCount=1
        )

    async def picture(self) -> bytes:
        """The page as PNG."""
        answer = await self.call("Page.captureScreenshot", format="png")
        return base64.b64decode(answer["data"])


async def first_page(port: int) -> str:
    """Address of the debugger of the browser's page, once it is there."""
    for _ in range(PATIENCE_S * 4):
        try:
            with urllib.request.urlopen(f"http://127.0.0.1:{port}/json", timeout=5) as answer:
                pages = [page for page in json.load(answer) if page["type"] == "page"]
            return str(pages[0]["webSocketDebuggerUrl"])
        except (OSError, IndexError):
            await asyncio.sleep(0.25)
    raise TimeoutError("the browser does not answer")


def page_address(output: IO[str]) -> str:
    """The address that a command with a page tells once it serves it."""
    told = ""
    for line in output:
        told += line
        if found := ADDRESS.search(line):
            return found[0]
    raise ConnectionError(f"the command tells no address: {told}")


async def look(page: str, debugger: int, share: float) -> bytes:
    """Open the page, wait, drag the set-point to about 3 V, wait, and take the picture."""
    browser = Browser(await websocket_connect(await first_page(debugger), max_message_size=1 << 26))
    size = {"width": WIDTH, "height": HEIGHT, "deviceScaleFactor": 1, "mobile": False}
    await browser.call("Emulation.setDeviceMetricsOverride", **size)
    await browser.call("Page.navigate", url=page)
    await asyncio.sleep(12)
    x = SLIDER_X + SLIDER_WIDTH * share
    for kind in ("mouseMoved", "mousePressed", "mouseReleased"):
        await browser.mouse(kind, x, SLIDER_Y)
        await asyncio.sleep(0.5)
    await asyncio.sleep(6)
    return await browser.picture()


class Programs(ExitStack):
    """Programs that end with the block."""

    def start(
        self, command: list[str], stdout: int = subprocess.DEVNULL, stderr: int = subprocess.DEVNULL
    ) -> subprocess.Popen[str]:
        """A program; its output is dropped but for the pipes."""
        process = subprocess.Popen(command, stdout=stdout, stderr=stderr, text=True)
        self.callback(process.wait)
        self.callback(process.terminate)
        return process

    def start_chromium(self) -> int:
        """The port of the developer tools of a headless browser with an empty page."""
        chromium = shutil.which(CHROMIUM)
        if chromium is None:
            raise SystemExit(f"{CHROMIUM} is not installed: apt install {CHROMIUM}")
        profile = self.enter_context(tempfile.TemporaryDirectory(ignore_cleanup_errors=True))
        debugger = free_port()
        options = ["--no-sandbox", "--disable-gpu", "--hide-scrollbars"]
        places = [f"--user-data-dir={profile}", f"--remote-debugging-port={debugger}"]
        self.start([chromium, *options, *places, "about:blank"])
        return debugger


def monitor_picture(project: str) -> tuple[bytes, dict[str, Any]]:
    """The picture, and what the monitor says at its end."""
    air, page = free_port(), free_port()
    with Programs() as programs:
        debugger = programs.start_chromium()
        live = ["live", str(ROOT / "examples" / project), "step"]
        programs.start([*RAVENBRICK, *live, "--bluetooth", f"tcp:{air}", "--json"])
        told_to = ["--page", f"{page}", "--seconds", f"{SECONDS}", "--json"]
        monitor = programs.start(
            [*RAVENBRICK, "monitor", f"tcp:{air}", *told_to],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
        )
        assert monitor.stderr is not None
        address = page_address(monitor.stderr)
        picture = asyncio.run(look(address, debugger, SET_POINTS[project]))
        told, _ = monitor.communicate(timeout=SECONDS + PATIENCE_S)
    return picture, json.loads(told)


def main(file: str, project: str = "motor-bench") -> int:
    """Write the picture and say what is in force."""
    picture, told = monitor_picture(project)
    Path(file).write_bytes(picture)
    print(json.dumps(told["parameters"]), told["runs"])
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
