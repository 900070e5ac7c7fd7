# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Schedulability of task sets on one processor: analysis, assignment, simulation."""

from __future__ import annotations

from ravenbrick.schedule.assignment import audsley, deadline_monotonic, rate_monotonic
from ravenbrick.schedule.edf import earliest_deadline_bounds, processor_demand_test
from ravenbrick.schedule.model import CriticalSection, Frame, Overheads, Task, TaskSet, TaskSetError
from ravenbrick.schedule.offsets import phased_response_time_bounds
from ravenbrick.schedule.response_time import (
    is_schedulable,
    non_preemptive_bounds,
    response_time_bounds,
)
from ravenbrick.schedule.sensitivity import largest_scaling, largest_wcet, smallest_period
from ravenbrick.schedule.simulation import simulate
from ravenbrick.schedule.task_models.sampled_chains import sampled_chain_bound

__all__ = [
    "CriticalSection",
    "Frame",
    "Overheads",
    "Task",
    "TaskSet",
    "TaskSetError",
    "audsley",
    "deadline_monotonic",
    "earliest_deadline_bounds",
    "is_schedulable",
    "largest_scaling",
    "largest_wcet",
    "non_preemptive_bounds",
    "phased_response_time_bounds",
    "processor_demand_test",
    "rate_monotonic",
    "response_time_bounds",
    "sampled_chain_bound",
    "simulate",
    "smallest_period",
]
