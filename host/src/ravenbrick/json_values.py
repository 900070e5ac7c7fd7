# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The values of a JSON text that anybody may have written."""

from __future__ import annotations

import json
from typing import Any

__all__ = ["json_values"]


def json_values(text: str | bytes) -> Any:
    """As `json.loads`; raises `ValueError` also for arrays in arrays without end."""
    try:
        return json.loads(text)
    except RecursionError:
        raise ValueError("too many values inside each other") from None
