# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The studio over HTTP: its page, the brick's page, results, files, and commands."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from functools import partial
from http.server import ThreadingHTTPServer
from typing import Any
from urllib.parse import parse_qs, urlsplit

from ravenbrick.json_values import json_values
from ravenbrick.local_server import PAGE_POLICY, PageHandler, listen
from ravenbrick.studio.project_files import LARGEST_BYTES, FileError
from ravenbrick.studio.studio import Studio

__all__ = ["studio_server"]

BRICK, RESULTS = "brick/", "results/"
# A text in JSON may be longer than its bytes.
LARGEST_REQUEST = 7 * LARGEST_BYTES
TICK_S = 1.0
_OWN_POLICY = (
    "default-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' data:; "
    "frame-src 'self'; frame-ancestors 'none'"
)
_BRICK_POLICY = PAGE_POLICY.replace("frame-ancestors 'none'", "frame-ancestors 'self'")
# A report is shown, and its script marks lines; it reaches nothing, not even this server.
_RESULT_POLICY = (
    "sandbox allow-scripts; default-src 'none'; style-src 'unsafe-inline'; img-src data:; "
    "script-src 'unsafe-inline'; frame-ancestors 'self'"
)


class _Handler(PageHandler):
    """`GET` asks, `POST` acts."""

    def __init__(
        self, *arguments: Any, studio: Studio, page: dict[str, bytes], **options: Any
    ) -> None:
        self._studio, self._own = studio, page
        super().__init__(*arguments, **options)

    def content_of(self, name: str) -> bytes | None:
        """See the base class."""
        if name.startswith(BRICK):
            return self._studio.page.get(name.removeprefix(BRICK))
        if name.startswith(RESULTS):
            return self._studio.result(name.removeprefix(RESULTS))
        return self._own.get(name)

    def policy_of(self, name: str) -> str:
        """See the base class."""
        if name.startswith(BRICK):
            return _BRICK_POLICY
        return _RESULT_POLICY if name.startswith(RESULTS) else _OWN_POLICY

    def answer_get(self, name: str) -> None:
        """A file, or an answer of the studio."""
        asked = {k: v[0] for k, v in parse_qs(urlsplit(self.path).query).items()}
        if name == "api/events":
            self._send_events()
        elif name == "api/project":
            self._answer(self._studio.described)
        elif name == "api/file":
            self._answer(lambda: self._studio.files.read(asked.get("path", "")))
        else:
            super().answer_get(name)

    def answer_post(self, name: str) -> None:
        """Save a file, start or stop a command."""
        if self.headers.get_content_type() != "application/json":
            self.send_error(415, "expected application/json")
        else:
            self._answer(lambda: self._obey(name, self._body()))

    def _body(self) -> dict[str, Any]:
        length = _number(self.headers.get("Content-Length", ""))
        if length is None or length > LARGEST_REQUEST:
            raise FileError(413, f"expected a request of at most {LARGEST_REQUEST} bytes")
        try:
            body = json_values(self.rfile.read(length))
        except ValueError:
            body = None
        if not isinstance(body, dict):
            raise FileError(400, "expected a JSON object")
        return body

    def _obey(self, name: str, body: dict[str, Any]) -> dict[str, Any]:
        if name == "api/save":
            path, text = _text(body, "path"), _text(body, "text")
            return self._studio.files.write(path, text, _text_or_none(body, "version"))
        if name == "api/run":
            self._studio.run(_text(body, "command"), _text_or_none(body, "scenario"))
        elif name == "api/stop":
            self._studio.stop()
        else:
            raise FileError(404, f"{name}: there is no such action")
        return {}

    def _answer(self, make: Callable[[], dict[str, Any]]) -> None:
        """Send what a function returns, or the error that it raises."""
        try:
            status, content = 200, make()
        except FileError as error:
            status, content = error.status, {"error": str(error), **error.data}
        except OSError as error:
            status, content = 500, {"error": f"{error.filename}: {error.strerror}"}
        self.send_content(status, "application/json", json.dumps(content).encode())

    def _send_events(self) -> None:
        """What happens, as it happens, until the page leaves."""
        studio = self._studio
        number = _number(self.headers.get("Last-Event-ID", "")) or 0
        self.send_response(200)
        self.send_header("Content-Type", "text/event-stream")
        self.end_headers()
        before = studio.files.state()
        with studio.listening():
            try:
                while not studio.closed:
                    for at, event in studio.journal.after(number, TICK_S):
                        number = at
                        self._send(f"id: {number}\ndata: {json.dumps(event)}\n\n")
                    state = studio.files.state()
                    both = {*state, *before}
                    changed = [name for name in both if state.get(name) != before.get(name)]
                    before = state
                    files = {"kind": "files", "changed": sorted(changed)}
                    self._send(f"data: {json.dumps(files)}\n\n" if changed else ":\n\n")
            except OSError:
                return

    def _send(self, text: str) -> None:
        self.wfile.write(text.encode())
        self.wfile.flush()


def _number(text: str) -> int | None:
    """Of a header's field; None for anything else, and for more digits than any such number has."""
    return int(text) if re.fullmatch("[0-9]{1,18}", text) else None


def _text(body: dict[str, Any], name: str) -> str:
    """Without halves of characters, which JSON can have and no file."""
    value = body.get(name)
    if not isinstance(value, str) or re.search("[\ud800-\udfff]", value):
        raise FileError(400, f"{name}: expected a text")
    return value


def _text_or_none(body: dict[str, Any], name: str) -> str | None:
    return None if body.get(name) is None else _text(body, name)


def studio_server(
    studio: Studio, page: dict[str, bytes], port: int, token: str
) -> ThreadingHTTPServer:
    """A server of the studio below a folder `token`; `page` are the studio's own files.

    Raises `UsageError`.
    """
    return listen(partial(_Handler, studio=studio, page=page, token=token), port)
