# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Servers for a browser on this machine: who may ask, and how files are handed out.

Pages of other sites reach such a server through the browser, so it answers to this machine's own
names only, below a token that no other site can guess.
"""

from __future__ import annotations

import re
import secrets
from collections.abc import Callable
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from mimetypes import guess_type
from pathlib import Path
from typing import Any
from zipfile import ZipFile

from ravenbrick.errors import ToolMissingError, UsageError, shown_path

__all__ = [
    "LOOPBACK",
    "PAGE_POLICY",
    "PageHandler",
    "access_token",
    "is_http",
    "is_local",
    "listen",
    "packed_files",
]

LOOPBACK = "127.0.0.1"
# The page needs its own files, its worker, and permission to compile the brick.
PAGE_POLICY = (
    "default-src 'self'; script-src 'self' 'wasm-unsafe-eval'; style-src 'self' 'unsafe-inline'; "
    "img-src 'self' data: blob:; connect-src 'self'; worker-src 'self'; frame-ancestors 'none'"
)
_TYPES = {".js": "text/javascript", ".wasm": "application/wasm", ".elf": "application/elf"}
_OTHER = "application/octet-stream"
_LOCAL = re.compile(r"(127\.0\.0\.1|localhost|\[::1\])(:\d+)?", re.IGNORECASE)
_METHODS = tuple(
    f"{name} /".encode() for name in ("GET", "POST", "PUT", "HEAD", "DELETE", "OPTIONS", "PATCH")
)


def access_token() -> str:
    """The first part of the path of a server's pages, which no other site can guess."""
    return secrets.token_urlsafe(12)


def is_local(host: str) -> bool:
    """Whether a Host header names this machine; a name that was bound to it later does not."""
    return _LOCAL.fullmatch(host) is not None


def is_http(data: bytes) -> bool | None:
    """Whether bytes begin as a browser's request; None while they are too few to know."""
    if data.startswith(_METHODS):
        return True
    return None if any(method.startswith(data) for method in _METHODS) else False


def packed_files(archive_file: Path) -> dict[str, bytes]:
    """The files of a page by their names; `make page` packs them. Raises `ToolMissingError`."""
    try:
        with ZipFile(archive_file) as archive:
            return {name: archive.read(name) for name in archive.namelist()}
    except Exception as error:  # readers of archives raise whatever their parts do
        raise ToolMissingError(
            f"{shown_path(archive_file)}: the page is missing or damaged ({error}); restore the "
            "file with 'git checkout', or build the page with 'make page'"
        ) from None


class PageHandler(BaseHTTPRequestHandler):
    """Hands out what `content_of` finds below the token."""

    path = ""  # of a request that is none, which is answered too

    def __init__(self, *arguments: Any, token: str, **options: Any) -> None:
        self._token = token
        super().__init__(*arguments, **options)

    def content_of(self, name: str) -> bytes | None:
        """The content of a file of the page; None where there is none."""
        raise NotImplementedError

    def policy_of(self, _name: str) -> str:
        """The content security policy of a file of the page."""
        return PAGE_POLICY

    def name_below_token(self) -> str | None:
        """The name that is asked for, "" for the page itself; None after an error was sent."""
        if not is_local(self.headers.get("Host", "")):
            self.send_error(421, "this server answers to the names of this machine only")
            return None
        whole = self.path.partition("?")[0].lstrip("/")
        if not whole.startswith(self._token):
            self.send_error(404)
            return None
        return whole.removeprefix(self._token).lstrip("/")

    def end_headers(self) -> None:
        """Nothing from elsewhere, nothing stale, and no token to elsewhere."""
        name = self.path.partition("?")[0].lstrip("/").removeprefix(self._token).lstrip("/")
        self.send_header("Content-Security-Policy", self.policy_of(name))
        self.send_header("X-Content-Type-Options", "nosniff")
        self.send_header("Referrer-Policy", "no-referrer")
        self.send_header("Cache-Control", "no-cache")
        super().end_headers()

    def send_content(self, status: int, content_type: str, content: bytes) -> None:
        """A whole answer; its head alone for HEAD."""
        self.send_response(status)
        self.send_header("Content-Type", content_type)
        self.send_header("Content-Length", str(len(content)))
        self.end_headers()
        if self.command != "HEAD":
            self.wfile.write(content)

    def answer_get(self, name: str) -> None:
        """Answer GET and HEAD for a name below the token."""
        if not name or name.endswith("/"):
            name += "index.html"
        content = self.content_of(name)
        if content is None:
            self.send_error(404)
        else:
            kind = _TYPES.get(Path(name).suffix) or guess_type(name)[0] or _OTHER
            self.send_content(200, kind, content)

    def answer_post(self, _name: str) -> None:
        """Answer POST for a name below the token, which the server's own page sent."""
        self.send_error(501, "this server only hands out files")

    def do_GET(self) -> None:
        """Head and content."""
        name = self.name_below_token()
        if name is not None:
            self.answer_get(name)

    def do_HEAD(self) -> None:
        """The head alone."""
        self.do_GET()

    def do_POST(self) -> None:
        """What a page of another site sends is refused."""
        name = self.name_below_token()
        if name is None:
            return
        if self.headers.get("Origin") != f"http://{self.headers.get('Host')}":
            self.send_error(403, "this server accepts actions from its own page only")
        else:
            self.answer_post(name)

    def log_message(self, *_arguments: Any) -> None:
        """Requests are not news."""


def listen(handler: Callable[..., PageHandler], port: int) -> ThreadingHTTPServer:
    """A server on this machine only; port 0 takes a free one. Raises `UsageError`."""
    try:
        return ThreadingHTTPServer((LOOPBACK, port), handler)
    except OSError as error:
        raise UsageError(
            f"the server cannot use port {port} ({error.strerror or error}); name a free one with "
            "'--port', or 0 to take any"
        ) from None
