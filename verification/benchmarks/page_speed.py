# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Speed of the page of `ravenbrick view` in headless Chromium."""

from __future__ import annotations

import gzip
import json
import os
import subprocess
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from tools.docs.pictures.monitor import page_address
from verification.benchmarks.figures import VEHICLE, Figure
from verification.commands import NoResultError
from verification.support.paths import ROOT

BUSY = Path(__file__).resolve().parent / "busy" / "busy.c"
PAGE_SECONDS = 5


def busy_image(folder: Path) -> Path:
    """A program without idle time, at the start of the RAM that the boot monitor leaves free."""
    image = folder / "busy.elf"
    command = ["arm-none-eabi-gcc", "-mcpu=arm7tdmi", "-O2", "-g", "-nostdlib", "-ffreestanding"]
    command += ["-fno-exceptions", "-fno-unwind-tables", "-fno-asynchronous-unwind-tables"]
    command += ["-Wl,-Ttext=0x202000", "-Wl,--build-id=none", "-o", str(image)]
    subprocess.run([*command, str(BUSY)], check=True)
    return image


def page_figures(image: Path | None, key: str | None) -> dict[str, Any]:
    """What `web/e2e/speed.mjs` measures in headless Chromium, as fast as the page can."""
    command = [str(ROOT / ".venv" / "bin" / "ravenbrick"), "view", str(VEHICLE), "--no-browser"]
    command += ["--port", "0", *(["--elf", str(image)] if image else [])]
    environment = {**os.environ, "PYTHONUNBUFFERED": "1", "COLUMNS": "200"}
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=environment) as server:
        assert server.stdout is not None
        address = page_address(server.stdout)
        words = ["node", "e2e/speed.mjs", address, str(PAGE_SECONDS), *([key] if key else [])]
        done = subprocess.run(words, cwd=ROOT / "web", capture_output=True, text=True)
        server.terminate()
    if done.returncode != 0:
        raise NoResultError(f"{' '.join(words)}: {done.stderr}")
    figures: dict[str, Any] = json.loads(done.stdout)
    return figures


def page_speed() -> Iterator[Figure]:
    """Times real speed in the browser's tab."""
    with tempfile.TemporaryDirectory() as folder:
        busy = page_figures(busy_image(Path(folder)), None)
    brick = ("virtual s per s", "the brick", 1.0)
    yield Figure("in the tab, busy program", busy["ratio"], *brick)
    moving = page_figures(None, "t")
    yield Figure("in the tab, vehicle driving", moving["ratio"], *brick)
    yield Figure("page, first contentful paint", moving["paint_ms"], "ms")
    yield Figure("page, brick ready to run", moving["ready_ms"], "ms")
    files = [path for path in (ROOT / "build" / "page").rglob("*") if path.is_file()]
    packed = sum(len(gzip.compress(path.read_bytes())) for path in files)
    yield Figure("page, all files packed", packed, "bytes")
