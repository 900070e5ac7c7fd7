# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""What the drivers cost, from the measured table, as parts of a task set.

An operation takes time of its task, causes interrupts, and may hold interrupts back; the drivers'
own tasks are tasks like any other. The table is `docs/reference/driver-costs.json`.
"""

from __future__ import annotations

import difflib
from collections.abc import Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from pathlib import Path
from typing import Any

from ravenbrick.json_values import json_values
from ravenbrick.schedule.model import Overheads, Task
from ravenbrick.schedule.quantity import Time, exact

__all__ = ["CostError", "DriverCosts", "read_driver_costs"]

UNITS = {"s": 1, "ms": 1_000, "us": 1_000_000}
CYCLES = "cycles"


class CostError(ValueError):
    """The table cannot be read, or does not have what is asked for."""


@dataclass(frozen=True)
class DriverCosts:
    """Cycles of operations and tasks, and how many cycles are a unit of time."""

    operations: Mapping[str, Mapping[str, int]]
    tasks: Mapping[str, Mapping[str, Any]]
    cycles_per_unit: Fraction
    units_per_ms: Fraction

    def _time(self, cycles: int) -> Time:
        return exact(Fraction(cycles) / self.cycles_per_unit)

    def _operation(self, name: str) -> Mapping[str, int]:
        if name not in self.operations:
            raise CostError(_unknown("operation", name, self.operations))
        return self.operations[name]

    def charged(self, task: Task, counts: Mapping[str, int], interrupt: int) -> list[Task]:
        """`task` with the operations of each job, and the interrupts that they cause as a task of
        the priority `interrupt`. Raises `CostError`."""
        own = sum(self._operation(name)["task_cycles"] * n for name, n in counts.items())
        caused = sum(self._operation(name)["interrupt_cycles"] * n for name, n in counts.items())
        tasks = [replace(task, wcet=exact(task.wcet + self._time(own)))]
        if caused:
            name = f"interrupts of {task.name}"
            wcet = self._time(caused)
            tasks.append(Task(name, task.period, wcet, interrupt, release="interrupt"))
        return tasks

    def driver_task(self, name: str, priority: int) -> Task:
        """A task of the drivers. Raises `CostError`."""
        if name not in self.tasks:
            raise CostError(_unknown("task of the drivers", name, self.tasks))
        row = self.tasks[name]
        period = exact(Fraction(str(row["period_ms"])) * self.units_per_ms)
        return Task(name, period, self._time(row["longest_cycles"]), priority)

    def overheads(self, before: Overheads, names: set[str]) -> Overheads:
        """`before` with a masked section as long as the longest of these operations."""
        longest = max((self._operation(name)["masked_cycles"] for name in names), default=0)
        masked = max(exact(before.masked_section), self._time(longest))
        return replace(before, masked_section=masked)


def _unknown(kind: str, name: str, known: Mapping[str, Any]) -> str:
    close = difflib.get_close_matches(name, known, 1, cutoff=0.4)
    advice = f"did you mean '{close[0]}'?" if close else f"there are {', '.join(known)}"
    return f"the table has no {kind} '{name}'; {advice}"


def read_driver_costs(path: Path, unit: str) -> DriverCosts:
    """The table for a task set in `unit`: s, ms, us or cycles. Raises `CostError`."""
    if unit not in (*UNITS, CYCLES):
        raise CostError(f"needs times in {', '.join(UNITS)} or {CYCLES}, not in '{unit}'")
    try:
        values = json_values(path.read_text(encoding="utf-8"))
        hertz = Fraction(*values["clock_hz"])
        operations = {row["name"]: row for row in values["operations"]}
        tasks = {row["name"]: row for row in values["tasks"]}
    except OSError as error:
        problem = f"'{path}' cannot be read ({error.strerror}); name driver-costs.json"
        raise CostError(problem) from None
    except (ValueError, KeyError, TypeError):
        raise CostError(
            f"'{path}' is not a table of driver costs; name driver-costs.json"
        ) from None
    cycles_per_unit = Fraction(1) if unit == CYCLES else hertz / UNITS[unit]
    return DriverCosts(operations, tasks, cycles_per_unit, hertz / 1000 / cycles_per_unit)
