# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Execution times of the jobs of a project's tasks, from its image."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

from ravenbrick.errors import DeadlineError
from ravenbrick.image.elf import ElfImage
from ravenbrick.project.robot import Task
from ravenbrick.timing.bounds import Bound, ExecutionTimeError, JobQuestion, execution_times
from ravenbrick.timing.facts.facts import Facts, KindOfJob
from ravenbrick.timing.task_set.background import endless_words, main_symbol
from ravenbrick.timing.task_set.scheduled_tasks import WAITS
from ravenbrick.timing.task_set.suspension import joined_releases
from ravenbrick.trace.recording import ENVIRONMENT

Annotations = Sequence[tuple[str, str]]
"""Texts of facts about code, with the names of their files."""
Jobs = list[tuple[Task, Bound]]
Kinds = Sequence[tuple[KindOfJob, Bound, tuple[int, ...]]]
"""Kinds of jobs with their bounds, and the bounds of each turn, if there are any."""


def body_of(image: ElfImage, executed: Mapping[str, str], task: Task) -> str:
    """Symbol of a task's body: the one that it began to execute, if it has begun, else the only
    one with its name. Raises `ExecutionTimeError` when it cannot be told."""
    if task.name == ENVIRONMENT:
        return main_symbol(image)
    name = task.name.lower()
    if name in executed:
        return executed[name]
    found = [symbol for symbol in image.symbols if symbol.endswith(f"__{name}TKB")]
    if len(found) == 1:
        return found[0]
    raise ExecutionTimeError(
        f"the image has {len(found)} bodies with the name of the task '{task.name}', and it does "
        "not begin with the others; declare it as a single task with another name"
    )


@dataclass(frozen=True)
class JobsOfTasks:
    """Bounds of the jobs of these tasks, with what is known of their code; `timing` is a profile of
    the timing that no document fixes, `executed` the bodies that tasks began to execute."""

    image: ElfImage
    facts: Facts
    tasks: Sequence[Task]
    annotations: Annotations
    timing: str
    executed: Mapping[str, str] = field(default_factory=dict)

    @cached_property
    def bodies(self) -> list[str]:
        """Symbols of the tasks' bodies."""
        return [body_of(self.image, self.executed, task) for task in self.tasks]

    @property
    def questions(self) -> list[JobQuestion]:
        """Of each task, its body and where its jobs wait."""
        waits = (WAITS[task.release] for task in self.tasks)
        return [(body, *wait) for body, wait in zip(self.bodies, waits, strict=True)]

    def _asked(
        self, questions: Sequence[JobQuestion], more: Annotations, paths: bool = False
    ) -> tuple[Bound, ...]:
        known = [*self.annotations, self.facts.of_jobs, *more]
        return execution_times(
            self.image.content,
            jobs=questions,
            annotations=known,
            timing=self.timing,
            paths=paths,
            requesting=[request.begin for request in self.facts.requests],
        ).jobs

    def bounds(self, more: Annotations = (), paths: bool = False) -> Jobs:
        """The jobs under more annotations; with `paths`, also their worst paths."""
        try:
            found = self._asked(self.questions, more, paths)
        except ExecutionTimeError as question:
            _check_endless(question, dict(zip(self.bodies, self.tasks, strict=True)))
            raise
        jobs = []
        for task, job, body in zip(self.tasks, found, self.bodies, strict=True):
            if self.facts.suspension(task.name) is None:
                job = joined_releases(task, job, body, lambda one: self._asked([one], more)[0])
            jobs.append((task, job))
        return jobs

    def under(self, more: Annotations, jobs: Jobs) -> Jobs:
        """The jobs under more annotations. One that is bounded by its kinds, also under these,
        stays as it is: it does no more to others then."""
        asked = [task for task, _ in jobs if not _kinds_bound(task, self.facts)]
        found = {task.name: job for task, job in replace(self, tasks=asked).bounds(more)}
        return [(task, found.get(task.name, job)) for task, job in jobs]

    @cached_property
    def _whole(self) -> dict[str, Bound]:
        """Bodies of the tasks by the task's name, in jobs and outside of them."""
        pairs = zip(self.tasks, self.questions, strict=True)
        asked = {task.name: own for task, own in pairs if self.facts.outside_of(task.name)}
        found = execution_times(
            self.image.content,
            background=self.bodies,
            outside=list(asked.values()),
            outside_places=tomllib.loads(self.facts.outside)["avoided"],
            annotations=self.annotations,
            timing=self.timing,
        )
        outside = dict(zip(asked, found.outside, strict=True))
        return {
            task.name: replace(body, outside_cycles=outside.get(task.name, 0))
            for task, body in zip(self.tasks, found.background, strict=True)
        }

    def with_outside(self, jobs: Jobs) -> Jobs:
        """Jobs with what their tasks do to others, and their stacks, also outside of jobs."""
        if not self.facts.outside_loads:
            return jobs
        stack = ("stack_bytes", "stack_lost", "stack_gap")
        names = (*stack, "critical_sections", "reached", "outside_cycles")

        def together(task: Task, job: Bound) -> Bound:
            whole = self._whole[task.name]
            return replace(job, **{name: getattr(whole, name) for name in names})

        return [(task, together(task, job)) for task, job in jobs]

    def kinds(self, stated: Annotations) -> Kinds:
        """Kinds of jobs with their bounds, and with their worst paths if nothing more is stated."""
        questions = dict(zip((task.name for task in self.tasks), self.questions, strict=True))
        found = []
        for kind in self.facts.kinds:
            if kind.task in questions:
                own = (f"{kind.file}, kind of job '{kind.name}'", kind.annotations)
                turns = self.facts.in_turn(kind.task)
                left_out = [[turn] for turn in turns.annotations] if turns else [[]]
                asked = [
                    self._asked([questions[kind.task]], [*stated, own, *each], not stated)[0]
                    for each in left_out
                ]
                cycles = tuple(bound.cycles for bound in asked) if turns else ()
                found.append((kind, max(asked, key=lambda bound: bound.cycles), cycles))
        return found


def _kinds_bound(task: Task, facts: Facts) -> bool:
    """Do kinds bound the jobs of a task? What a job that waits inside executes and waits is longest
    together, which its kinds do not tell."""
    stated = any(kind.task == task.name for kind in facts.kinds)
    return stated and task.release == "cyclic" and facts.suspension(task.name) is None


def longest_kinds(jobs: Jobs, kinds: Kinds, facts: Facts) -> Jobs:
    """The jobs, each as the longest of its kinds, if these bound it."""
    found = []
    for task, job in jobs:
        if _kinds_bound(task, facts):
            own = (bound for kind, bound, _ in kinds if kind.task == task.name)
            longest = max(own, key=lambda bound: bound.cycles)
            if longest.cycles < job.cycles:
                path, report = longest.path, longest.report
                job = replace(job, cycles=longest.cycles, path=path, report=report)
        found.append((task, job))
    return found


def _check_endless(question: ExecutionTimeError, tasks: dict[str, Task]) -> None:
    """Whatever the answer to a question is, a task that stays in a loop misses its deadline.

    Raises `DeadlineError` for such a task."""
    for body, line in question.data.get("endless", {}).items():
        task = tasks[body]
        words = f"NOT schedulable: {endless_words(task, line, list(tasks.values()))}"
        raise DeadlineError(words, detail=f"{question}\n{question.detail}") from question
