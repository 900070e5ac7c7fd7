# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The optional libraries of the file formats."""

from __future__ import annotations

import importlib
from typing import Any

from ravenbrick.errors import ToolMissingError

__all__ = ["library"]


def library(module: str, package: str) -> Any:
    """Import a module of an optional package; raises `ToolMissingError`."""
    try:
        return importlib.import_module(module)
    except ImportError:
        raise ToolMissingError(
            f"this format needs the Python package '{package}'; "
            "install it with \"pip install 'ravenbrick[export]'\""
        ) from None
