# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Published measurements of real motors repeated on the plant.

`python -m verification.plant.points` measures and writes `points.json` and, from it,
docs/reference/plant-points.md.
"""

from __future__ import annotations

import json
import subprocess
import sys
from collections import Counter
from typing import Any

from tools.docs import tables
from verification.commands import Counts, NoResultError
from verification.support.paths import ROOT

RESULTS = ROOT / "verification" / "plant" / "points.json"
COMMAND = ["cargo", "run", "--locked", "--quiet", "--release", "-p", "plant"]


def measure() -> dict[str, Any]:
    """Points with the value of each set; written to the results file."""
    command = [*COMMAND, "--example", "published_points"]
    result = subprocess.run(command, cwd=ROOT / "virtual-brick", capture_output=True, text=True)
    if result.returncode != 0:
        raise NoResultError(f"published_points\n{result.stderr[-2000:]}")
    data: dict[str, Any] = json.loads(result.stdout)
    parts = [
        f'"{key}": [\n' + ",\n".join(json.dumps(row, sort_keys=True) for row in value) + "\n]"
        if isinstance(value, list)
        else f'"{key}": {json.dumps(value)}'
        for key, value in sorted(data.items())
    ]
    RESULTS.write_text("{\n" + ",\n".join(parts) + "\n}\n")
    return data


def suite() -> Counts:
    """Values with a band, those within, and those out with their reasons; keeps the data."""
    data = measure()
    judged = [m["passes"] for p in data["points"] for m in p["measured"] if m["passes"] is not None]
    reasons = Counter(miss["reason"] for miss in data["missed"])
    excluded = [{"count": n, "reason": reason} for reason, n in sorted(reasons.items())]
    return Counts(len(judged), sum(judged), excluded)


if __name__ == "__main__":
    measure()
    sys.exit(tables.main([]))
