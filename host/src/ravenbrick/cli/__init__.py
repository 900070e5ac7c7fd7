# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The command line; one module per command."""

from __future__ import annotations

import os
import sys

from ravenbrick import __version__

__all__ = ["VERSION_LINE", "main"]

VERSION_LINE = f"ravenbrick {__version__}"


def main() -> None:
    """Entry point of the program `ravenbrick`."""
    if sys.argv[1:] == ["--version"]:
        print(VERSION_LINE)
        return
    # Our matrices are small: threads for them only take processor time.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    try:
        from ravenbrick.cli.app import app  # all that --version does without
    except KeyboardInterrupt:
        from ravenbrick.errors import ExitCode

        print("ravenbrick: interrupted", file=sys.stderr)
        sys.exit(ExitCode.INTERRUPTED)
    app(prog_name="ravenbrick")
