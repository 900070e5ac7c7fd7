# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Pages of this computer, whatever proxy the environment names for others."""

from __future__ import annotations

import urllib.request
from typing import Any

__all__ = ["open_page"]

LONGEST_S = 300
_DIRECT = urllib.request.build_opener(urllib.request.ProxyHandler({}))


def open_page(address: str | urllib.request.Request) -> Any:
    """The answer of a server of this computer; raises `HTTPError`."""
    return _DIRECT.open(address, timeout=LONGEST_S)
