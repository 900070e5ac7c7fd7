# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Who may ask a server of this machine: pages of other sites reach it through the browser."""

from __future__ import annotations

import re
import secrets

__all__ = ["access_token", "is_http", "is_local"]

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
