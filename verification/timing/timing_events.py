# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""A program with timing events, analysed and run on the virtual brick.

`python -m verification.timing.timing_events` prints bounds and largest values seen as JSON.
"""

from __future__ import annotations

import json
import sys
from typing import Any

from ravenbrick.timing.observed import check_event_rates, observe

from verification.timing.ada_programs import Subject, analysed, subject

__all__ = ["compared", "events"]


def events() -> Subject:
    """The program of the folder `events`."""
    return subject("events", "expiring_load")


def compared() -> list[dict[str, Any]]:
    """Bounds beside the largest values seen, for each task; cycles."""
    program = events()
    analysis, recording = analysed(program, program.facts), program.run()
    check_event_rates(program.robot, program.facts, recording)
    seen = observe(program.robot, recording)
    rows = []
    for timing in analysis.tasks:
        name = timing.task.name
        bound = analysis.bounds[name].bound
        pairs = {
            "execution": [timing.job.cycles, seen[name].execution_cycles],
            "response": [None if bound is None else int(bound), seen[name].response_cycles],
            "stack": [timing.stack_bound_bytes, seen[name].stack_bytes],
        }
        rows.append({"task": name, **pairs})
    return rows


def main() -> int:
    """Print the comparison."""
    print(json.dumps(compared(), indent=1))
    return 0


if __name__ == "__main__":
    sys.exit(main())
