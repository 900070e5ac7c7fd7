# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The published JSON schemas of the project files."""

from __future__ import annotations

import json
from functools import cache
from pathlib import Path
from typing import Any

from ravenbrick.catalogue import sensor_kinds

__all__ = ["schema"]


@cache
def schema(name: str) -> dict[str, Any]:
    """The schema `name`; the catalogue gives the kinds of sensors, `robot` what a task is."""
    text = Path(__file__).with_name(f"{name}.schema.json").read_text("utf-8")
    loaded: dict[str, Any] = json.loads(text)
    if name == "robot":
        device = loaded["$defs"]["sensor_port"]["properties"]["device"]
        device["enum"] = list(sensor_kinds())
    if name == "rubric":
        loaded["$defs"]["task"] = schema("robot")["$defs"]["task"]
    return loaded
