# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The bricks that pages of the documentation ask for: project, scenario and the steps before."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

from ravenbrick.project.templates import TEMPLATES, template_of

from examples.devices.pictures import EXAMPLES as DEVICES
from tools.docs.lessons import FENCE, ROOT, steps

__all__ = [
    "EXAMPLES",
    "PAGE_FOLDER",
    "SHOWN_FOLDER",
    "Shown",
    "changing_steps",
    "printed",
    "shown_on",
]

# In the site; the page looks for its bricks in the folder beside its own.
PAGE_FOLDER = "_static/brick"
SHOWN_FOLDER = "_static/bricks"
EXAMPLES = ROOT / "examples"
NEW = re.compile(r"ravenbrick new (\S+) --template (\S+)$")
# Commands of a sheet that make or change files; the others build, run or judge.
KEPT = re.compile(r"(ravenbrick new|sed|cp|mv|rm|mkdir)\b")
SCRIPT = re.compile(r"python3 (\S+\.py)$")
DIRECTIVE = re.compile(r"^```\{brick\} (\S+) (\S+)\n((?:(?!```).*\n)*)```$", re.MULTILINE)


@dataclass(frozen=True)
class Shown:
    """A brick of the site; `steps` are those of a sheet that lead to it, "" for an example."""

    name: str
    project: str
    scenario: str
    example: str
    template: str | None
    steps: str = ""

    @property
    def device(self) -> str | None:
        """The program for a single device that this is; it has no project and no scenario."""
        folder, _, name = self.example.partition("/")
        return name if folder == "devices" else None

    @property
    def title(self) -> str:
        """Project and scenario for the reader."""
        return self.device or f"{self.project}, scenario {self.scenario}"


def changing_steps(text: str) -> str:
    """A sheet's text with only those commands that make or change files.

    A script of the sheet is one of these if it writes text; others read what a run left.
    """
    writers = {step.argument for step in steps(text) if "write_text(" in step.content}

    def is_kept(command: str) -> bool:
        script = SCRIPT.match(command)
        return script.group(1) in writers if script else KEPT.match(command) is not None

    def kept(match: re.Match[str]) -> str:
        language, word, _value, content = match.groups()
        if language == "console":
            lines = [line for line in content.splitlines() if is_kept(line)]
            return "\n".join(["```console", *lines, "```"]) if lines else ""
        return "" if word == "seen" else match.group(0)

    return FENCE.sub(kept, text)


def _changes(text: str, project: str) -> bool:
    for step in steps(text):
        if step.kind == "console":
            if any(not NEW.match(line) for line in step.content.splitlines()):
                return True
        elif step.argument.startswith(f"{project}/"):
            return True
    return False


def _checked(shown: Shown) -> Shown:
    folder = EXAMPLES / shown.example
    if shown.device in DEVICES and not DEVICES[shown.device].outside:
        return shown
    if not (folder / "robot.toml").is_file():
        raise ValueError(
            f"there is no example '{shown.example}', and no step above with "
            f"'ravenbrick new {shown.project}'"
        )
    scenario = folder / "scenarios" / f"{shown.scenario}.toml"
    if not scenario.is_file() and f"/scenarios/{shown.scenario}.toml" not in shown.steps:
        raise ValueError(f"'{shown.project}' has no scenario '{shown.scenario}'")
    return shown


def _shown(above: str, project: str, scenario: str) -> Shown:
    """The brick of a directive below this text of a sheet."""
    made = {}
    for step in steps(above):
        for command in step.content.splitlines() if step.kind == "console" else ():
            if match := NEW.match(command):
                made[match.group(1)] = match.group(2)
    if project not in made:
        name = f"{project.replace('/', '-')}-{scenario}"
        template = None if project.startswith("devices/") else template_of(project)
        return _checked(Shown(name, project, scenario, project, template))
    template = made[project]
    example = TEMPLATES[template].example
    changing = changing_steps(above)
    if not _changes(changing, project):
        return _checked(Shown(f"{example}-{scenario}", project, scenario, example, template))
    name = f"{project}-{scenario}"
    return _checked(Shown(name, project, scenario, example, template, changing))


def shown_on(page: Path) -> list[Shown]:
    """The bricks of a page in order; raises `ValueError` where a project or scenario is unknown."""
    text = page.read_text("utf-8")
    found: dict[str, Shown] = {}
    bricks = []
    for match in DIRECTIVE.finditer(text):
        place = f"{page.name}:{text.count(chr(10), 0, match.start()) + 1}"
        try:
            shown = _shown(text[: match.start()], match[1], match[2])
        except ValueError as error:
            raise ValueError(f"{place}: {error}") from None
        if found.setdefault(shown.name, shown).steps != shown.steps:
            raise ValueError(f"{place}: above is another '{shown.name}'; leave one of them out")
        bricks.append(shown)
    return bricks


def printed(text: str) -> str:
    """A page's text for paper: each brick becomes its caption and the commands that show it."""

    def line(match: re.Match[str]) -> str:
        project, scenario, content = match.groups()
        caption = " ".join(part for part in content.splitlines() if not part.startswith(":"))
        return (
            f"{caption} *(On the site it runs here; or: `ravenbrick view {project} {scenario}`.)*"
        )

    return DIRECTIVE.sub(line, text)
