# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""`ravenbrick design --page`: a gain that is dragged in the browser."""

from __future__ import annotations

import asyncio
import json
import re
import signal
import socket
import subprocess
import sys
import urllib.error
import urllib.request
from collections.abc import Iterator
from pathlib import Path

import pytest
from tornado.websocket import websocket_connect
from typer.testing import CliRunner
from verification.support.web import open_page

from ravenbrick.cli.app import app

VEHICLE = Path(__file__).resolve().parents[3] / "examples" / "vehicle"
WIDTH, HEIGHT = 1200, 800


async def drag(address: str, x: float, y: float) -> None:
    """Press, as a browser does, at a place given as shares of the figure from below."""
    place = {"x": x * WIDTH, "y": (1 - y) * HEIGHT, "button": 0, "buttons": 1, "modifiers": []}
    connection = await websocket_connect(address.replace("http", "ws") + "1/ws")
    for kind in ("button_press", "button_release"):
        await connection.write_message(json.dumps({"type": kind, **place}))
    # The answer to this one is a picture, after everything before it.
    await connection.write_message(json.dumps({"type": "draw"}))
    while not isinstance(await connection.read_message(), bytes):
        pass
    connection.close()


@pytest.fixture
def page() -> Iterator[tuple[subprocess.Popen[str], str]]:
    """The command, and the address of its page."""
    with socket.create_server(("127.0.0.1", 0)) as free:
        port = free.getsockname()[1]
    arguments = ["design", str(VEHICLE), "--page", str(port), "--json"]
    with subprocess.Popen(
        [sys.executable, "-u", "-c", "from ravenbrick.cli import main; main()", *arguments],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    ) as process:  # fmt: skip
        assert process.stderr is not None
        said = (re.search(r"the page is (http://\S+/);", line) for line in process.stderr)
        yield process, next(found[1] for found in said if found)
        process.kill()


def test_the_page_is_for_this_machine(page: tuple[subprocess.Popen[str], str]) -> None:
    """Other hosts' names, and addresses without the token, get nothing."""
    address = page[1]
    with open_page(address) as answer:
        assert 'id="figures"' in answer.read().decode("utf-8")
    for url, host, code in (
        (address, "attacker.example", 421),
        (f"{address}1/ws", "attacker.example", 421),
        (re.sub(r"/[^/]+/$", "/", address), "localhost", 404),
    ):
        with pytest.raises(urllib.error.HTTPError, match=str(code)):
            open_page(urllib.request.Request(url, headers={"Host": host}))


def test_a_gain_is_dragged_in_the_page(page: tuple[subprocess.Popen[str], str]) -> None:
    """The gains at the end are those of the page."""
    process, address = page
    # The lowest slider is Kp's, from 0 to four times the design's 0.314445.
    asyncio.run(drag(address, 0.36 + 0.5 * 0.75, 0.035))
    process.send_signal(signal.SIGINT)
    told, errors = process.communicate(timeout=300)
    assert process.returncode == 0, errors
    gains = json.loads(told)["gains"]
    assert gains["Kp"] == pytest.approx(3 * 0.314445, rel=0.02)
    assert gains["Ki_Ts"] == pytest.approx(0.032221)


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        ([str(VEHICLE), "--page", "9000", "--plots"], "--page draws by itself"),
        ([str(VEHICLE.with_name("balancer")), "--page", "9000"], "'design' returns no Design"),
    ],
)
def test_what_the_page_cannot_show_is_refused(arguments: list[str], sentence: str) -> None:
    """Options that draw to files, and loops that are no speed loops."""
    done = CliRunner().invoke(app, ["design", *arguments])
    assert done.exit_code != 0
    assert sentence in " ".join(done.output.split())
