# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""What a submission is graded by, typed, and how it is read."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from ravenbrick import __version__
from ravenbrick.errors import UsageError
from ravenbrick.grading.answers import parse_wanted
from ravenbrick.grading.draws import Pulses
from ravenbrick.grading.race import race_of
from ravenbrick.grading.robot_text import own_robot_text
from ravenbrick.grading.variants import (
    Individual,
    Variant,
    drawn_variant,
    filled,
    individual_of,
    middle_variant,
)
from ravenbrick.project.criteria import ExpectationSyntaxError, parse_expectation
from ravenbrick.project.named_files import is_file, named_file
from ravenbrick.project.robot import ROBOT_FILE, Robot, read_robot, tasks_of
from ravenbrick.project.scenario import read_scenario
from ravenbrick.project.workspace import tree
from ravenbrick.schemas.located_toml import LocatedToml, read_toml
from ravenbrick.schemas.validation import validate

__all__ = ["Check", "Limits", "Rubric", "check_row", "read_rubric"]

KINDS = (
    "expect", "criteria", "race", "stack_share_at_most", "memory_at_most", "builds", "answer",
)  # fmt: skip
RUNS = ("expect", "criteria", "race", "stack_share_at_most")
PROJECT_FILES = ("application.gpr", "ravenbrick.cgpr", "run_time.gpr")
# What a result depends on besides submission and rubric.
RUBRICS = Path("docs/lessons/rubrics")
TOOLS = ("drivers/src", "runtime", *(f"tools/{name}" for name in PROJECT_FILES))


@dataclass(frozen=True)
class Limits:
    """Of the work on one submission; memory and files per process."""

    design_seconds: int = 60
    build_seconds: int = 120
    run_seconds: int = 300
    memory_mb: int = 4096
    file_mb: int = 256


@dataclass(frozen=True)
class Check:
    """One line of the rubric; `kind` is one of KINDS, `value` what it asks for.

    `own` is asked for instead where each student has a variant; braces hold expressions.
    """

    name: str
    points: float
    kind: str
    value: Any
    scenario: Path | None
    seeds: tuple[int, ...]
    hidden_seeds: int
    pulses: Pulses | None
    hidden: bool
    place: str
    own: str = ""


@dataclass(frozen=True)
class Rubric:
    """A whole rubric; `digest` covers all that a result depends on but the submission."""

    path: Path
    name: str
    description: str
    project: Path
    folders: tuple[str, ...]
    keep: frozenset[str]
    limits: Limits
    checks: tuple[Check, ...]
    robot: Robot
    digest: str
    individual: Individual | None = None
    robot_text: bytes | None = None
    other_tasks: bool = False

    def variant(self, key: bytes, student: str) -> Variant:
        """The student's robot and numbers; raises `UsageError` where all have the same."""
        if self.individual is None:
            raise UsageError(f"the rubric '{self.name}' has no table [individual]")
        sheet = self.individual.sheet or self.name
        return drawn_variant(self.robot, self.individual, key, sheet, student)

    def of(self, variant: Variant) -> Rubric:
        """This rubric with the variant's robot, its robot.toml and its numbers."""
        checks = (
            replace(check, value=filled(check.own, variant.facts)) if check.own else check
            for check in self.checks
        )
        text = (self.project / ROBOT_FILE).read_text("utf-8")
        if self.individual is not None and not self.individual.hidden:
            text = own_robot_text(text, self.robot, variant.robot)
        return replace(
            self, robot=variant.robot, checks=tuple(checks), robot_text=text.encode("utf-8")
        )

    @property
    def needs_image(self) -> bool:
        """Some check is about the program."""
        return any(check.kind != "answer" for check in self.checks)

    @property
    def points(self) -> float:
        """All that can be had."""
        return sum(check.points for check in self.checks)


def check_row(check: Check, share: float, found: str) -> dict[str, Any]:
    """A check's row of a result: its share of the points, and what was found."""
    return {
        "name": check.name,
        "points": round(share * check.points, 4),
        "of": check.points,
        "hidden": check.hidden,
        "found": found,
    }


def digest_of(files: Iterable[Path], root: Path) -> str:
    """Digest over names, relative to `root`, and contents."""
    digest = hashlib.sha256()
    for file in sorted(files):
        name, content = file.relative_to(root).as_posix(), file.read_bytes()
        digest.update(f"{len(name)} {name} {len(content)} ".encode())
        digest.update(content)
    return digest.hexdigest()


def _files(folder: Path) -> list[Path]:
    return [
        path for path in folder.rglob("*") if path.is_file() and "__pycache__" not in path.parts
    ]


def _tools_digest() -> str:
    root = tree()
    files = [
        f for name in TOOLS for p in [root / name] for f in ([p] if p.is_file() else _files(p))
    ]
    return digest_of(files, root)


def _scenario(document: LocatedToml, index: int, name: str, robot: Robot) -> Path:
    beside = document.path.parent / name
    named = robot.directory / "scenarios" / f"{name}.toml"
    path = beside if is_file(beside) else named
    if not is_file(path):
        raise document.error(
            ("checks", index, "scenario"),
            f"neither {beside} nor {named} is there; correct the name",
        )
    read_scenario(path, robot)
    return path


def _check(document: LocatedToml, index: int, table: Mapping[str, Any], robot: Robot) -> Check:
    kinds = [kind for kind in KINDS if kind in table]
    if len(kinds) != 1:
        raise document.error(
            ("checks", index), f"expected exactly one of {', '.join(KINDS)}, found {len(kinds)}"
        )
    kind = kinds[0]
    if (kind in RUNS) != ("scenario" in table):
        must = "needs a 'scenario'" if kind in RUNS else "runs nothing; remove 'scenario'"
        raise document.error(("checks", index), f"'{kind}' {must}")
    place = f"{document.path}:{document.line_of(('checks', index))}"
    try:
        pulses = Pulses(**table["pulses"]) if "pulses" in table else None
    except ValueError as error:
        raise document.error(("checks", index, "pulses"), str(error)) from None
    if pulses and kind != "expect":
        raise document.error(("checks", index, "pulses"), "needs 'expect'")
    if kind == "expect":
        try:
            parse_expectation(
                pulses.filled(table["expect"], 0) if pulses else table["expect"], place
            )
        except ExpectationSyntaxError as error:
            raise document.error(("checks", index, "expect"), str(error)) from None
    if "own" in table and (kind not in ("expect", "answer") or pulses):
        raise document.error(
            ("checks", index, "own"), "needs 'answer', or 'expect' without 'pulses'"
        )
    if kind == "answer":
        try:
            parse_wanted(table["answer"])
        except ValueError as error:
            raise document.error(("checks", index, "answer"), str(error)) from None
    value = table[kind]
    if kind == "race":
        try:
            value = race_of(value, robot)
        except ValueError as error:
            raise document.error(("checks", index, "race"), str(error)) from None
    scenario = table.get("scenario")
    return Check(
        name=table["name"],
        points=float(table["points"]),
        kind=kind,
        value=value,
        scenario=scenario and _scenario(document, index, scenario, robot),
        seeds=tuple(table.get("seeds", ())),
        hidden_seeds=table.get("hidden_seeds", 0),
        pulses=pulses,
        hidden=table.get("hidden", False),
        place=place,
        own=table.get("own", ""),
    )


def _individual(
    document: LocatedToml, robot: Robot, checks: tuple[Check, ...]
) -> Individual | None:
    """The table [individual]; every `own` is tried with the project's robot."""
    table = document.values.get("individual")
    if table is None:
        return None
    try:
        individual = individual_of(table)
    except ValueError as error:
        raise document.error(("individual", "numbers"), str(error)) from None
    for index, port in enumerate(individual.motors):
        if port not in robot.motor_ports:
            raise document.error(
                ("individual", "motors", index), f"nothing is plugged into motor port {port}"
            )
    for place, name in enumerate(individual.records):
        if not is_file(document.path.parent / name):
            raise document.error(("individual", "records", place), f"there is no file '{name}'")
    facts = middle_variant(robot, individual).facts
    for index, check in enumerate(checks):
        try:
            if check.own and check.kind == "answer":
                parse_wanted(filled(check.own, facts))
            elif check.own:
                parse_expectation(filled(check.own, facts), check.place)
        except (ValueError, ExpectationSyntaxError) as error:
            raise document.error(("checks", index, "own"), str(error)) from None
    return individual


def read_rubric(path: Path) -> Rubric:
    """Read a rubric and all that it names; raises `ProjectFileError` or `ScenarioError`."""
    path = named_file(path, tree(), tree() / RUBRICS, ".toml") or path
    document = read_toml(path, missing="name a rubric, a TOML file, or one of docs/lessons/rubrics")
    validate(document, "rubric")
    values = document.values
    project = (path.parent / values["project"]).resolve()
    if not is_file(project / "robot.gpr"):
        raise document.error(("project",), f"'{project}' has no robot.gpr; name a project")
    robot = read_robot(project)
    if "tasks" in values:
        robot = replace(robot, tasks=tasks_of(document))
    checks = tuple(_check(document, i, t, robot) for i, t in enumerate(values["checks"]))
    used = {path, *_files(project), *(c.scenario for c in checks if c.scenario)}
    names = "".join(sorted(digest_of([file], file.parent) for file in used))
    return Rubric(
        individual=_individual(document, robot, checks),
        path=path,
        name=values["name"],
        description=values.get("description", ""),
        project=project,
        folders=tuple(values.get("folders", ("src", "generated"))),
        keep=frozenset(values.get("keep", ())),
        limits=Limits(**values.get("limits", {})),
        checks=checks,
        robot=robot,
        other_tasks=values.get("other_tasks", False),
        digest=hashlib.sha256(f"{__version__} {_tools_digest()} {names}".encode()).hexdigest(),
    )
