# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""How to install what is missing, in a checkout and from a wheel."""

from __future__ import annotations

import importlib
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from ravenbrick import __version__
from ravenbrick.errors import ToolMissingError

__all__ = [
    "advice_for_packages",
    "advice_for_python",
    "brick_module",
    "in_checkout",
    "optional_module",
]

PACKAGE = Path(__file__).resolve().parent


def in_checkout() -> bool:
    """Whether the package runs from a checkout of the tree, which has a set-up of its own."""
    return (PACKAGE.parents[2] / "tools" / "setup").is_file()


def advice_for_packages(packages: Iterable[str]) -> str:
    """The one command that installs Debian packages."""
    names = " ".join(dict.fromkeys(packages))
    return f"run 'apt-get install --no-install-recommends {names}' as root"


def advice_for_python() -> str:
    """What brings the compiled module and the Python packages that the program needs."""
    if in_checkout():
        return "run 'make setup'"
    return (
        f"install the wheel of ravenbrick {__version__} again with 'pip install --force-reinstall'"
    )


def brick_module() -> Any:
    """The compiled module `virtual_brick`; raises `ToolMissingError`."""
    try:
        return importlib.import_module("virtual_brick")
    except ImportError as error:
        raise ToolMissingError(
            f"the Python module 'virtual_brick' cannot be loaded ({error}); {advice_for_python()}"
        ) from None


def optional_module(
    name: str, package: str, extra: str = "export", user: str = "this format"
) -> Any:
    """Import a module that `user` needs, of a package in the group `extra` of `pyproject.toml`.

    Raises `ToolMissingError`.
    """
    try:
        return importlib.import_module(name)
    except ImportError as error:
        raise ToolMissingError(
            f"{user} needs the Python package '{package}' ({error}); "
            f"run \"pip install 'ravenbrick[{extra}]'\""
        ) from None
