# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Answers of a debugger's server, for tests that speak GDB's protocol themselves."""

from __future__ import annotations

import socket

__all__ = ["whole_reply"]


def whole_reply(connection: socket.socket) -> bytes:
    """Acknowledgement and packet, which may come in pieces: `+$...#xx`."""
    reply = b""
    while len(reply.partition(b"#")[2]) < 2:
        piece = connection.recv(100)
        assert piece, f"the connection ended after {reply!r}"
        reply += piece
    return reply
