# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The command line; one module per command."""

from __future__ import annotations

import sys

from ravenbrick.cli.app import app

__all__ = ["app", "main"]


def main() -> None:
    """Entry point of the program `ravenbrick`."""
    app.load(sys.argv[1:2])
    app()
