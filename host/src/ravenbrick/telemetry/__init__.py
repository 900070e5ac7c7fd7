# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The live link: a program's signals arrive, its parameters change, while the robot runs."""

from __future__ import annotations

from ravenbrick.telemetry.links import LinkLostError, open_link
from ravenbrick.telemetry.monitor import Monitor, replay
from ravenbrick.telemetry.session import Session, VersionError
from ravenbrick.telemetry.spool import Spool

__all__ = [
    "LinkLostError",
    "Monitor",
    "Session",
    "Spool",
    "VersionError",
    "open_link",
    "replay",
]
