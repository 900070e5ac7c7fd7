# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The tree and its products, for campaigns, benchmarks and helpers of tests."""

from __future__ import annotations

import os
from pathlib import Path

__all__ = ["BUILD", "ROOT"]

ROOT = Path(__file__).resolve().parents[2]
BUILD = Path(os.environ.get("RAVENBRICK_BUILD", ROOT / "build")).resolve()
