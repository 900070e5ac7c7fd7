# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Background threads: a main procedure that goes on beside the tasks, and background tasks.

They are less urgent than all other tasks and have no deadline, so they delay others only as any
less urgent task does: by protected actions and masked services. One that waits for a time has the
alarm called for it. While a task or handler is active, such a thread does not run, so it cannot
set the alarm anew: at most one call comes in each busy period, which is a constant like blocking.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from ravenbrick.image.elf import ElfImage
from ravenbrick.project.robot import Robot, Task
from ravenbrick.timing.alarm import AlarmCosts
from ravenbrick.timing.bounds import Bound, ExecutionTimeError, execution_times
from ravenbrick.timing.initial_state import ENVIRONMENT, main_rests
from ravenbrick.timing.kernel import DELAY_UNTIL

__all__ = ["NO_BACKGROUND", "Background", "background_of"]

MAIN = "_ada_"


@dataclass(frozen=True)
class Background:
    """Background threads with what bounds their effects on others."""

    threads: tuple[tuple[Task, Bound], ...] = ()

    def alarm_cycles(self, alarm: AlarmCosts) -> int:
        """Calls of the alarm in a busy period."""
        waiting = [job for _, job in self.threads if DELAY_UNTIL in job.reached]
        return len(waiting) * (alarm.first + alarm.early)


NO_BACKGROUND = Background()


def _main_symbol(image: ElfImage) -> str:
    found = [name for name in image.symbols if name.startswith(MAIN)]
    if len(found) == 1:
        return found[0]
    raise ExecutionTimeError(
        f"{image.path}: the main procedure goes on beside the tasks, and {len(found)} symbols "
        f"begin with '{MAIN}', so its code is not known; write it in Ada, or end it with 'delay "
        "until Ada.Real_Time.Time_Last;'"
    )


def _main_thread(brick: Any) -> Task:
    """The main procedure as the elaborated brick shows it."""
    thread = next(found for found in brick.threads() if found.name == ENVIRONMENT)
    return Task(
        name=ENVIRONMENT,
        description="the main procedure",
        release="background",
        period_us=None,
        deadline_us=None,
        priority=thread.base_priority,
        stack_bytes=thread.stack_size,
    )


def _delayed(thread: Task, tasks: Sequence[Task]) -> str:
    """Tasks that do not run while a thread computes, in words; empty without any."""
    least = [task for task in tasks if task.priority <= thread.priority]
    return ", ".join(f"{task.name} (priority {task.priority})" for task in least)


def _check_main(main: Task, tasks: Sequence[Task], image: ElfImage) -> None:
    delayed = _delayed(main, tasks)
    if delayed:
        raise ExecutionTimeError(
            f"{image.path}: the main procedure goes on beside the tasks at priority "
            f"{main.priority} and does not let these run while it computes: {delayed}; give it the "
            "lowest priority (pragma Priority (System.Priority'First) in its declarations, and "
            "higher ones to all tasks), or end it with 'delay until Ada.Real_Time.Time_Last;'"
        )


def background_of(
    robot: Robot,
    image: ElfImage,
    brick: Any,
    body_of: Callable[[Task], str],
    annotations: Sequence[tuple[str, str]],
    timing: str,
) -> Background:
    """Background threads of a program that `brick` has elaborated.

    Raises `ProjectFileError` for a background task that is as urgent as another task, and
    `ExecutionTimeError` for a main procedure that is, and for critical sections without a bound.
    """
    timed = [task for task in robot.tasks if task.release != "background"]
    threads, symbols = [], []
    for index, task in enumerate(robot.tasks):
        if task.release != "background":
            continue
        if delayed := _delayed(task, timed):
            raise robot.document.error(
                ("tasks", index, "priority"),
                f"is {task.priority}, and a background task does not let these run while it "
                f"computes: {delayed}; give it a lower priority than all of them",
            )
        threads.append(task)
        symbols.append(body_of(task))
    if robot.task(ENVIRONMENT) is None and not main_rests(brick):
        main = _main_thread(brick)
        _check_main(main, timed, image)
        threads.append(main)
        symbols.append(_main_symbol(image))
    if not threads:
        return NO_BACKGROUND
    found = execution_times(
        image.content, background=symbols, annotations=annotations, timing=timing
    )
    return Background(tuple(zip(threads, found.background, strict=True)))
