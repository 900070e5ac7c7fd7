# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Libraries that are loaded at their first use: together they take more than a second to load."""

from __future__ import annotations

import sys
from importlib.util import LazyLoader, find_spec, module_from_spec
from types import ModuleType
from typing import TYPE_CHECKING

__all__ = ["control", "linalg", "optimize", "stats"]


def _lazy_module(name: str) -> ModuleType:
    """The module, of which nothing is executed before the first access to what is in it.

    The package that holds it is loaded at once.
    """
    if name in sys.modules:
        return sys.modules[name]
    spec = find_spec(name)
    if spec is None or spec.loader is None:
        raise ModuleNotFoundError(f"No module named '{name}'", name=name)
    spec.loader = LazyLoader(spec.loader)
    module = sys.modules[name] = module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


if TYPE_CHECKING:
    import control
    from scipy import linalg, optimize, stats
else:
    control = _lazy_module("control")
    linalg = _lazy_module("scipy.linalg")
    optimize = _lazy_module("scipy.optimize")
    stats = _lazy_module("scipy.stats")
