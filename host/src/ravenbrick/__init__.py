# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Ravenbrick on the host computer: design, build, run and measure."""

from __future__ import annotations

__all__ = ["__version__"]

__version__ = "0.4.0"
