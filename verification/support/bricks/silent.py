# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""A virtual brick with nothing around it."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from ravenbrick.brick.step_cost import BENCH


def silent_brick(image: Path) -> Any:
    """The brick with an image, before its first instruction."""
    import virtual_brick

    return virtual_brick.VirtualBrick(json.dumps(BENCH), image.read_bytes())
