# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Where another program on this computer finds a brick's byte stream: a TCP port or a terminal."""

from __future__ import annotations

import errno
import os
import pty
import socket
import tty
from typing import Protocol

from ravenbrick.errors import UsageError
from ravenbrick.local_server import is_http

__all__ = ["BytePort", "listening_socket", "open_port", "waiting_client"]

_LOOPBACK = "127.0.0.1"
_CHUNK = 4096


class BytePort(Protocol):
    """One client at a time; nothing here waits."""

    address: str

    @property
    def in_use(self) -> bool:
        """A client is there."""

    def read(self) -> bytes:
        """What the client has sent."""

    def write(self, data: bytes) -> None:
        """Bytes for the client; lost when there is none."""

    def close(self) -> None:
        """No more clients."""


def listening_socket(port: int, any_port: str) -> socket.socket:
    """A socket on 127.0.0.1 that does not wait; `any_port` is how a user asks for a free one."""
    try:
        server = socket.create_server((_LOOPBACK, port))
    except OSError as error:
        raise UsageError(
            f"port {port} of this computer cannot be used ({error.strerror}); name another "
            f"one, or {any_port} for any"
        ) from None
    server.setblocking(False)
    return server


def waiting_client(server: socket.socket) -> socket.socket | None:
    """The next client that waits, which does not block either; None when there is none."""
    try:
        client, _ = server.accept()
    except BlockingIOError:
        return None
    client.setblocking(False)
    return client


class TcpPort:
    """A listening socket on 127.0.0.1; a second client waits until the first has gone."""

    def __init__(self, port: int) -> None:
        self._server = listening_socket(port, any_port="tcp:0")
        self._client: socket.socket | None = None
        self._unsent = b""
        self._first: bytes | None = b""
        self.address = f"tcp:{self._server.getsockname()[1]}"

    @property
    def in_use(self) -> bool:
        """A client is there; takes the next one that waits."""
        if self._client is None:
            self._client = waiting_client(self._server)
            self._unsent, self._first = b"", b""
        return self._client is not None

    def read(self) -> bytes:
        """What the client has sent; notices when it has gone."""
        if self._client is None:
            return b""
        try:
            data = self._client.recv(_CHUNK)
        except BlockingIOError:
            return b""
        except OSError:
            data = b""
        if not data:
            self._drop()
        return self._known(data)

    def _known(self, data: bytes) -> bytes:
        """The data, unless a browser sends it: any site can have one post to a port here."""
        if self._first is None or not data:
            return data
        self._first += data
        request = is_http(self._first)
        if request:
            self._drop()
        if request is not False:
            return b""
        data, self._first = self._first, None
        return data

    def write(self, data: bytes) -> None:
        """Bytes for the client; one that takes none for 64 KB is let go."""
        if self._client is None:
            return
        self._unsent += data
        try:
            sent = self._client.send(self._unsent) if self._unsent else 0
        except BlockingIOError:
            sent = 0
        except OSError:
            self._drop()
            return
        self._unsent = self._unsent[sent:]
        if len(self._unsent) > 16 * _CHUNK:
            self._drop()

    def _drop(self) -> None:
        if self._client is not None:
            self._client.close()
        self._client = None

    def close(self) -> None:
        """No more clients."""
        self._drop()
        self._server.close()


class PseudoTerminal:
    """A terminal that other programs open like a serial device."""

    def __init__(self) -> None:
        self._ours, theirs = pty.openpty()
        tty.setraw(theirs)
        self.address = os.ttyname(theirs)
        os.close(theirs)
        os.set_blocking(self._ours, False)
        self._open = False

    @property
    def in_use(self) -> bool:
        """Something has come, and the device is still open."""
        return self._open

    def read(self) -> bytes:
        """What the client has sent."""
        try:
            data = os.read(self._ours, _CHUNK)
        except BlockingIOError:
            return b""
        except OSError as error:
            if error.errno != errno.EIO:
                raise
            self._open = False
            return b""
        self._open = True
        return data

    def write(self, data: bytes) -> None:
        """Bytes for the client; what does not fit into the terminal's queue is lost."""
        if self._open and data:
            try:
                os.write(self._ours, data)
            except BlockingIOError:
                return

    def close(self) -> None:
        """No more clients."""
        os.close(self._ours)


def open_port(address: str) -> BytePort:
    """Offer `tcp:PORT` on 127.0.0.1 (0 takes any), or `pty`; raises `UsageError`."""
    if address == "pty":
        return PseudoTerminal()
    scheme, _, number = address.partition(":")
    if scheme != "tcp" or not number.isdigit() or int(number) > 65_535:
        raise UsageError(f"'{address}': expected pty, or tcp:PORT with a port of 0 to 65535")
    return TcpPort(int(number))
