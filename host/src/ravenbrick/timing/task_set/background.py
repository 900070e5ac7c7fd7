# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Background threads: a main procedure that goes on beside the tasks, and background tasks.

They have no deadline. Less urgent than all other tasks, they delay others only as any less urgent
task does: by protected actions and masked services. One that waits for a time has the alarm called
for it. While a task or handler is active, such a thread does not run, so it cannot set the alarm
anew: at most one call comes in each busy period, which is a constant like blocking.

A thread that never waits again lets no task of its priority or a lower one run, under
FIFO_Within_Priorities (Ada Reference Manual, D.2.3).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

from ravenbrick.image.elf import ElfImage
from ravenbrick.project.robot import Robot, Task
from ravenbrick.timing.bounds import Bound, ExecutionTimeError, execution_times
from ravenbrick.timing.environment_stack import EnvironmentStack
from ravenbrick.timing.initial_state import main_rests
from ravenbrick.timing.kernel import DELAY_UNTIL, WAITING
from ravenbrick.timing.task_set.alarm import AlarmCosts
from ravenbrick.trace.recording import ENVIRONMENT

__all__ = [
    "NO_BACKGROUND",
    "Background",
    "background_of",
    "delayed_tasks",
    "endless_words",
    "main_symbol",
    "never_waits",
]

MAIN = "_ada_"
# The binder's constant with the main procedure's symbol: other library procedures begin alike.
MAIN_NAME = "__gnat_ada_main_program_name"
LOWEST_PRIORITY = (
    "give it the lowest priority (pragma Priority (System.Priority'First) in its declarations, and "
    "higher ones to all tasks), or end it with 'delay until Ada.Real_Time.Time_Last;'"
)
WAIT_IN_LOOP = (
    "let it wait there for its next release, or declare it in robot.toml with "
    'release = "background" and give it a lower priority than all other tasks'
)


@dataclass(frozen=True)
class Background:
    """Background threads with what bounds their effects on others."""

    threads: tuple[tuple[Task, Bound], ...] = ()
    never_waiting: tuple[tuple[Task, Bound], ...] = ()

    def with_never_waiting(self, tasks: Sequence[tuple[Task, Bound]]) -> Background:
        """With tasks that stay in a loop and never wait."""
        return replace(self, never_waiting=(*self.never_waiting, *tasks))

    def with_stacks(self, environment: EnvironmentStack) -> Background:
        """With the whole stack of the environment task."""
        found = (self.threads, self.never_waiting)
        return Background(
            *(
                tuple((task, environment.of_job(task.name, job)) for task, job in each)
                for each in found
            )
        )

    @property
    def all_threads(self) -> tuple[tuple[Task, Bound], ...]:
        """Those that tasks are no less urgent than, and those that keep tasks from running."""
        return (*self.threads, *self.never_waiting)

    def alarm_cycles(self, alarm: AlarmCosts) -> int:
        """Calls of the alarm in a busy period."""
        waiting = [job for _, job in self.threads if DELAY_UNTIL in job.reached]
        return len(waiting) * (alarm.first + alarm.early)


NO_BACKGROUND = Background()


def main_symbol(image: ElfImage) -> str:
    """Symbol of the main procedure. Raises `ExecutionTimeError` when it cannot be told."""
    found = [name for name in image.symbols if name.startswith(MAIN)]
    if len(found) > 1 and MAIN_NAME in image.symbols:
        symbol = image.symbols[MAIN_NAME]
        named = image.bytes_at(symbol.address, symbol.size).rstrip(b"\0").decode("ascii", "replace")
        found = [name for name in found if name == named]
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


def delayed_tasks(thread: Task, tasks: Sequence[Task]) -> str:
    """Tasks that do not run while a thread computes, in words; empty without any."""
    least = [task for task in tasks if task.priority <= thread.priority and task != thread]
    return ", ".join(f"{task.name} (priority {task.priority})" for task in least)


def never_waits(bound: Bound) -> bool:
    """Whether a thread neither ends nor calls anything in which it could wait."""
    return bound.endless is not None and not WAITING & bound.reached


def endless_words(thread: Task, line: str, tasks: Sequence[Task]) -> str:
    """A thread that stays in a loop without a wait: where, whom it delays, what to change."""
    is_main = thread.name == ENVIRONMENT
    who = "the main procedure stays" if is_main else f"{thread.name} can stay"
    where = f" at {line}" if line else ""
    delayed = delayed_tasks(thread, tasks)
    whom = f", and then none of these runs again: {delayed}" if delayed else ""
    remedy = LOWEST_PRIORITY if is_main else WAIT_IN_LOOP
    return (
        f"{who} in the loop{where} for ever at priority {thread.priority}, without a wait"
        f"{whom}; {remedy}"
    )


def _refuse_main(main: Task, delayed: str, image: ElfImage) -> ExecutionTimeError:
    return ExecutionTimeError(
        f"{image.path}: the main procedure goes on beside the tasks at priority "
        f"{main.priority} and does not let these run while it computes: {delayed}; "
        f"{LOWEST_PRIORITY}; if it waits in its own loop, declare it in robot.toml as the task "
        f"'{ENVIRONMENT}'"
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
    `ExecutionTimeError` for a main procedure that is and does not go on for ever without a wait,
    and for critical sections without a bound.
    """
    timed = [task for task in robot.tasks if task.release != "background"]
    threads, symbols = [], []
    for index, task in enumerate(robot.tasks):
        if task.release != "background":
            continue
        if delayed := delayed_tasks(task, timed):
            raise robot.document.error(
                ("tasks", index, "priority"),
                f"is {task.priority}, and a background task does not let these run while it "
                f"computes: {delayed}; give it a lower priority than all of them",
            )
        threads.append(task)
        symbols.append(body_of(task))
    if robot.task(ENVIRONMENT) is None and not main_rests(brick):
        threads.append(_main_thread(brick))
        symbols.append(main_symbol(image))
    if not threads:
        return NO_BACKGROUND
    found = execution_times(
        image.content, background=symbols, annotations=annotations, timing=timing
    )
    known = tuple(zip(threads, found.background, strict=True))
    main, bound = known[-1]
    if main.name != ENVIRONMENT or not (delayed := delayed_tasks(main, timed)):
        return Background(known)
    if not never_waits(bound):
        raise _refuse_main(main, delayed, image)
    return Background(known[:-1], known[-1:])
