# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The adapter: OpenOCD's protocol `remote_bitbang` on a TCP port, one letter a change of lines."""

from __future__ import annotations

import socket
import subprocess
import threading
from pathlib import Path

from verification.support.jtag.core import DebugCore
from verification.support.jtag.tap import Tap

TIMEOUT_S = 120.0
CHUNK = 65_536


def _serve(server: socket.socket, core: DebugCore) -> None:
    line, _ = server.accept()
    with line:
        tap = Tap(core)
        while data := line.recv(CHUNK):
            answers = bytearray()
            for letter in data.decode():
                if "0" <= letter <= "7":
                    levels = int(letter)
                    tap.lines(levels >> 2, levels >> 1 & 1, levels & 1)
                elif letter == "R":
                    answers.append(ord("0") + tap.tdo)
                elif letter == "Q":
                    return
            line.sendall(answers)


def run_openocd(
    configuration: Path, commands: list[str], core: DebugCore
) -> subprocess.CompletedProcess[str]:
    """Run OpenOCD's commands with this core behind its adapter."""
    with socket.create_server(("127.0.0.1", 0)) as server:
        server.settimeout(TIMEOUT_S)
        port = server.getsockname()[1]
        adapter = f"adapter driver remote_bitbang; remote_bitbang port {port}; "
        adapter += "remote_bitbang host 127.0.0.1; gdb_port disabled"
        thread = threading.Thread(target=_serve, args=(server, core), daemon=True)
        thread.start()
        words = [w for c in [*commands, "shutdown"] for w in ("-c", c)]
        return subprocess.run(
            ["openocd", "-c", adapter, "-f", str(configuration), *words],
            capture_output=True,
            text=True,
            timeout=TIMEOUT_S,
            check=False,
        )
