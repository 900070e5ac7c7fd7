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
    """Values of the richer model with a band, those within, and why others are out."""
    data = measure()
    rich = [one for point in data["points"] for one in point["measured"] if one["rich"]]
    judged = [one["passes"] for one in rich if one["passes"] is not None]
    names = {one["set"] for one in rich}
    reasons = Counter(miss["reason"] for miss in data["missed"] if miss["set"] in names)
    excluded = [{"count": n, "reason": reason} for reason, n in sorted(reasons.items())]
    return Counts(len(judged), sum(judged), excluded)


if __name__ == "__main__":
    measure()
    sys.exit(tables.main([]))
