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
        import signal  # as the rest: all that --version does without

        from ravenbrick.cli.app import app

        app(prog_name="ravenbrick")
    except KeyboardInterrupt:
        _interrupted()
    finally:
        # The answer is given; what is left is the interpreter's own end.
        signal.signal(signal.SIGINT, signal.SIG_IGN)


def _interrupted() -> None:
    """Ctrl-C before the program could answer for itself."""
    if "--json" in sys.argv:
        print('{"ok": false, "exit_code": 130, "error": "interrupted", "detail": ""}')
    else:
        print("ravenbrick: interrupted", file=sys.stderr)
    sys.exit(130)
