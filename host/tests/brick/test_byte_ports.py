# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The TCP port of a live brick takes bytes from programs, not from pages of a browser."""

from __future__ import annotations

import socket

import pytest

from ravenbrick.brick.links.byte_ports import TcpPort

LONGEST_S = 300
FRAME = b"\x00\x02\x41\x01\x00"


def received(port: TcpPort, count: int) -> bytes:
    """So many bytes, or fewer when the client is gone."""
    data = b""
    while not port.in_use:
        pass
    while port._client is not None and len(data) < count:
        data += port.read()
    return data


@pytest.mark.parametrize("method", ["POST", "GET", "OPTIONS"])
def test_a_request_of_a_browser_is_no_telemetry(method: str) -> None:
    """Any site can have a page post to a port of this computer; the next client is served."""
    port = TcpPort(0)
    where = ("127.0.0.1", int(port.address.removeprefix("tcp:")))
    try:
        with socket.create_connection(where, timeout=LONGEST_S) as browser:
            browser.sendall(method[:2].encode())
            browser.sendall(f"{method[2:]} / HTTP/1.1\r\n\r\n".encode() + FRAME)
            assert received(port, 1) == b""
        with socket.create_connection(where, timeout=LONGEST_S) as monitor:
            monitor.sendall(FRAME)
            assert received(port, len(FRAME)) == FRAME
    finally:
        port.close()


def test_bytes_that_begin_like_a_request_are_not_lost() -> None:
    """They are kept until it is known that they are none."""
    port = TcpPort(0)
    where = ("127.0.0.1", int(port.address.removeprefix("tcp:")))
    try:
        with socket.create_connection(where, timeout=LONGEST_S) as monitor:
            for piece in (b"P", b"OS", b"x\x00"):
                monitor.sendall(piece)
            assert received(port, 5) == b"POSx\x00"
    finally:
        port.close()
