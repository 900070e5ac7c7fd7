# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Ravenbrick on the host computer: design, build, run and measure."""

from __future__ import annotations

import os

__all__ = ["__version__"]

# Matrices are small: threads of the linear algebra library cost ten times what they give, and
# the last bits of a result would depend on the number of processors. Before NumPy is loaded.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

__version__ = "0.4.0"
