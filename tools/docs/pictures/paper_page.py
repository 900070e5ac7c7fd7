# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The paper's vehicle on the page of the brick: `python -m tools.docs.pictures.paper_page FILE`.

Serves examples/paper with the scenario `drive`, lets it run in headless Chromium, and writes the
picture as PNG when the vehicle has driven for a while. Needs what `ravenbrick view` needs.
"""

from __future__ import annotations

import asyncio
import subprocess
import sys
from pathlib import Path

from tornado.websocket import websocket_connect

from tools.docs.pictures.monitor import RAVENBRICK, Browser, Programs, first_page, page_address

ROOT = Path(__file__).resolve().parents[3]
WIDTH, HEIGHT = 1280, 900
UNTIL_S = 10.5
PATIENCE_S = 240
TIME = "Number.parseFloat(document.querySelector('#time')?.textContent ?? '0')"


async def value(browser: Browser, expression: str) -> object:
    """What an expression gives in the page."""
    answer = await browser.call("Runtime.evaluate", expression=expression, returnByValue=True)
    return answer["result"].get("value")


async def driven(page: str, debugger: int) -> bytes:
    """Open the page, press Run, wait until the vehicle has turned, and take the picture."""
    browser = Browser(await websocket_connect(await first_page(debugger), max_message_size=1 << 26))
    size = {"width": WIDTH, "height": HEIGHT, "deviceScaleFactor": 1, "mobile": False}
    await browser.call("Emulation.setDeviceMetricsOverride", **size)
    await browser.call("Page.navigate", url=page)
    for _ in range(PATIENCE_S * 2):
        ready = await value(browser, "document.querySelector('#run')?.disabled === false")
        if ready:
            await value(browser, "document.querySelector('#run').click()")
            break
        await asyncio.sleep(0.5)
    for _ in range(PATIENCE_S * 2):
        seconds = await value(browser, TIME)
        if isinstance(seconds, (int, float)) and seconds >= UNTIL_S:
            await value(browser, "document.querySelector('#run').click()")
            await asyncio.sleep(1)
            return await browser.picture()
        await asyncio.sleep(0.5)
    raise TimeoutError("the vehicle does not drive")


def main(file: str) -> int:
    """Write the picture."""
    with Programs() as programs:
        debugger = programs.start_chromium()
        view = ["view", str(ROOT / "examples" / "paper"), "drive", "--no-browser", "--port", "0"]
        server = programs.start([*RAVENBRICK, *view], stdout=subprocess.PIPE)
        assert server.stdout is not None
        page = page_address(server.stdout)
        Path(file).write_bytes(asyncio.run(driven(page, debugger)))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
