# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Tests that a profile admits once their tasks and objects stand at library level.

`adaptations` says what is done to which test; the text of the suite is read where it is, changed
and built, and nothing of it is kept. A main procedure is *hoisted*: its declarations and those of
its outer block become a library package, each task gets a static stack, and the statements run
when the tasks have had their time. Some programs of the suite handle an exception that here ends
the program; they become several, each of which expects one end.
"""

from __future__ import annotations

import re
import tomllib
from dataclasses import dataclass, field, replace
from functools import cache, partial
from pathlib import Path
from typing import Any

from verification.acats.build import Memory
from verification.acats.suite import AcatsTest, Suite

__all__ = ["MEMORY", "Adaptation", "AdaptationError", "adaptations"]

RULES = Path(__file__).resolve().parent / "adaptations"
STACK_BYTES = 4_096
SETTLING_SECONDS = 2
MEMORY = Memory(stack_bytes=8_192, heap_bytes=1_024, secondary_stack_kib=1)
"""Each of the tasks has stacks of its own."""
COMMENT = re.compile(r'^((?:[^"\n-]|"[^"\n]*"|-(?!-))*)--.*$', re.M)
TASK = re.compile(r"(?i)^(\s*)task(\s+type)?\s+(?!body\b)(\w+)(\s*\([^)]*\))?\s*(is\b|;)", re.M)


class AdaptationError(Exception):
    """The suite's text is not as the rule expects."""


@dataclass(frozen=True)
class Adaptation:
    """One program made from a test.

    `profile`: the run-time, "ravenscar", "jorvik" or "jorvik-priority"; `without`: tasks that are
    left out; `substitutions`: pattern and text; `expected`: pattern of the failure with which the
    program must end, empty when it must report a pass; `hoisted`: whether the declarations of the
    main procedure move to library level.
    """

    test: str
    variant: str
    profile: str
    what: str
    without: tuple[str, ...] = ()
    substitutions: tuple[tuple[str, str], ...] = field(default=())
    expected: str = ""
    hoisted: bool = True
    stack_bytes: int = STACK_BYTES
    settling_seconds: int = SETTLING_SECONDS

    @property
    def name(self) -> str:
        """Of the outcome: the test and, where there are several, the variant."""
        return f"{self.test}-{self.variant}" if self.variant else self.test

    def apply(self, suite: Suite, test: AcatsTest, folder: Path) -> AcatsTest:
        """The test with its files replaced by changed ones in `folder`.

        Raises:
            AdaptationError: A task or a text that the rule names is not there.
        """
        folder.mkdir(parents=True, exist_ok=True)
        paths = []
        for path in test.files:
            text = COMMENT.sub(r"\1", suite.text(path))
            for name in self.without:
                text = _without(text, name)
            for pattern, by in self.substitutions:
                text, count = re.subn(pattern, by, text, flags=re.M)
                if count == 0:
                    raise AdaptationError(f"{self.name}: no '{pattern}' in {path.name}")
            if self.hoisted and re.search(rf"(?im)^procedure\s+{self.test}\b", text):
                text = TASK.sub(partial(_with_stack, self.stack_bytes), text)
                text = hoisted(text, self.test, self.settling_seconds)
            changed = folder / path.name
            changed.write_text(text, encoding="latin-1")
            paths.append(changed)
        return replace(test, files=tuple(paths))


def _with_stack(size_bytes: int, match: re.Match[str]) -> str:
    """A task's declaration with a static stack."""
    indent, of_type, name, discriminants, rest = match.groups()
    head = f"{indent}task{of_type or ''} {name}{discriminants or ''} is "
    head += f"pragma Storage_Size ({size_bytes});"
    return head if rest.lower() == "is" else f"{head} end {name};"


def _without(text: str, task: str) -> str:
    """The text without the declaration and the body of a task."""
    pattern = rf"(?is)^\s*task\s+(body\s+)?{task}\s+is\b.*?^\s*end\s+{task}\s*;"
    text, count = re.subn(pattern, "", text, flags=re.M)
    if count != 2:
        raise AdaptationError(f"no declaration and body of the task {task}")
    return text


def hoisted(text: str, name: str, settling_seconds: int) -> str:
    """The main procedure `name` as a package whose operation `Run` has its statements.

    The main procedure's `begin` stands at the beginning of a line, its outer block's `declare`,
    `begin` and `end` below each other, as everywhere in the suite.
    """
    whole = re.search(
        rf"(?ims)^(?P<before>.*)^procedure\s+{name}\s+is(?P<outer>.*?)"
        rf"^begin\b(?P<first>.*?)(?:^\w+\s*:\s*)?^(?P<indent>[ ]+)declare\b(?P<inner>.*?)"
        rf"^(?P=indent)begin\b(?P<middle>.*?)^(?P=indent)end\b[^;]*;(?P<last>.*)^end\s+{name}\s*;",
        text,
    )
    if whole is None:
        raise AdaptationError(f"{name}: the outline of the main procedure is another")
    part = whole.groupdict()
    units, context = _context(part["before"])
    package = f"{name}_Hoisted"
    return f"""{units}
package {package} is
   procedure Run;
end {package};
{context}
with Ada.Real_Time;
package body {package} is
{part["outer"]}
   package Beginning is
   end Beginning;
   package body Beginning is
   begin
{part["first"]}
   end Beginning;
{part["inner"]}
   procedure Run is
   begin
      delay until Ada.Real_Time."+"
        (Ada.Real_Time.Clock, Ada.Real_Time.Seconds ({settling_seconds}));
      begin
{part["middle"]}
      end;
{part["last"]}
   end Run;
end {package};
with {package};
procedure {name} is
begin
   {package}.Run;
end {name};
"""


def _context(before: str) -> tuple[str, str]:
    """Units before the main procedure, and its own context clauses."""
    ends = [match.end() for match in re.finditer(r"(?im)^end\b[^;]*;|^\s*pragma[^;]*;", before)]
    cut = ends[-1] if ends else 0
    return before[:cut], before[cut:]


@cache
def adaptations() -> tuple[Adaptation, ...]:
    """All programs of the folder `adaptations`, by the names of their tests."""
    found = []
    rules: dict[str, Any] = {}
    for file in RULES.glob("*.toml"):
        rules |= tomllib.loads(file.read_text())
    for test, rule in sorted(rules.items()):
        for variant in rule.get("variants", [{}]):
            changes = [*rule.get("substitutions", ()), *variant.get("substitutions", ())]
            found.append(
                Adaptation(
                    test=test,
                    variant=variant.get("name", ""),
                    profile=rule.get("profile", "ravenscar"),
                    what=rule.get("what", ""),
                    without=tuple(variant.get("without", ())),
                    substitutions=tuple((pattern, by) for pattern, by in changes),
                    expected=variant.get("expected", ""),
                    hoisted=rule.get("hoisted", True),
                    stack_bytes=rule.get("stack_bytes", STACK_BYTES),
                    settling_seconds=rule.get("settling_seconds", SETTLING_SECONDS),
                )
            )
    return tuple(found)
