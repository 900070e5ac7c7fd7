# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Table of public Simulink models: how many are read, simulate and become C.

`python -m verification.control.public_models` writes docs/reference/simulink-models.md from the
models in the folder that RAVENBRICK_SLX_MODELS names (`<owner>/<repository>/<model>`). Rows of
repositories that are not there stay, with their date.
"""

from __future__ import annotations

import hashlib
import os
import re
import signal
import sys
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import cache
from itertools import takewhile
from pathlib import Path

from ravenbrick.codegen import generate_c
from ravenbrick.errors import DesignError, RavenbrickError
from ravenbrick.simulink import ModelSource, Survey, survey_simulink
from ravenbrick.simulink.numbers import Workspace
from ravenbrick.simulink.rates import base_rate
from ravenbrick.simulink.simulate import simulate
from ravenbrick.simulink.workspace import assignments, script

from verification.run import today
from verification.support.paths import ROOT

REFERENCE = ROOT / "docs" / "reference"
SUFFIXES = (".slx", ".mdl")
THE_32 = ("EFeru/bldc-motor-control-FOC", "Firmament-Autopilot/FMT-Model")
FIRST = (
    "BondreaStefan/DC_motor_speed_control", "Nusrat-16/Lego-mindstrom-design",
    "ShomaNakatani/test-simulink-test", "ahmdnbil/MBD", "dapperfu/Jenkins-Simulink-Embedded-Coder",
    "dothanhlong01012002/Model-Based-Design-System", "drumwasher/SW-camp-Project",
    "eklashossain/MATLAB-and-Simulink-Crash-Course-for-Enginners",
    "hpong11/STM32F769_Matlab_Simulink", "kongsgard/NXT-Robotics-Control",
    "michael-hart/Imperial-Vex-2014", "ntthang-dev/gPBL-Control-System-Design-Arduino-MATLAB",
    "osudrl/atrias", "snehadubey9066/MBD_week2_ques4",
)  # fmt: skip
ASIDE = (
    "AshrithSagar/MATLAB-Simulink-Lab", "Zhao-Jichao/Matlab_Simulink_BookExample",
    "danielrherber/control-engineering-examples", "kseikoff/control-theory-labs",
    "lmberard/control-matlab-simulink",
)  # fmt: skip
GROUPS = (
    "of the first 14 repositories, two thirds looked at since 2026-11-23",
    "of these, a third set aside until 2026-11-27, then looked at",
    "of other repositories, looked at on 2026-11-27",
    "set aside: chosen by name and counted before the changes of 2026-11-27, not looked at",
)
TOTALS = "## All models"
_PROCESSOR_SECONDS = 10
_STOP = 10.0
_REASONS = (
    ("physical", "physical modelling"),
    ("not a signal", "physical modelling"),
    ("Stateflow", "Stateflow charts"),
    ("S-Function", "S-functions, whose programs are compiled"),
    ("is not at hand", "libraries that are not public: devices, toolboxes"),
    ("outside the model", "MATLAB System objects and referenced models that are absent"),
    ("complex", "complex signals"),
    ("Complex", "complex signals"),
    ("(MATLAB", "programs in MATLAB's language"),
    ("expected", "sizes of signals; most follow from variables that are not at hand"),
    ("elements", "sizes of signals; most follow from variables that are not at hand"),
    ("ncompatible", "sizes of signals; most follow from variables that are not at hand"),
    ("algebraic loop", "algebraic loops"),
    ("no signal to show", "models without a signal"),
    ("not finite", "states that become infinite"),
    ("processor", f"more than {_PROCESSOR_SECONDS} s of a processor"),
    ("(", "blocks without a counterpart"),
)


class _TooLongError(Exception):
    pass


def models_in(folder: Path) -> list[Path]:
    """Model files, without those that a Mac keeps beside its own."""
    paths = (p for p in folder.rglob("*") if p.suffix.lower() in SUFFIXES)
    return sorted(path for path in paths if not path.name.startswith("._"))


def kept_rows(page: str, gone: Callable[[str], bool]) -> list[str]:
    """Rows of the page's last table whose first cell is that of something which is not here."""
    table = page.rpartition("---|\n")[2].splitlines()
    return [row for row in table if row.startswith("| ") and gone(row.split(" | ")[0][2:])]


def group_of(owner: str, path: Path) -> int | None:
    """The place in `GROUPS`; of the first repositories a third was set aside by its digests."""
    if owner in THE_32:
        return None
    if owner in ASIDE:
        return 3
    if owner not in FIRST:
        return 2
    return int(int(hashlib.sha256(path.read_bytes()).hexdigest()[:8], 16) % 3 == 0)


@cache
def _scripts(top: Path) -> list[tuple[Path, str]]:
    found = ((path, script(path)) for path in sorted(top.rglob("*.m")))
    return [(path, text) for path, text in found if text is not None]


def _alike(one: str, two: str) -> int:
    """How many letters two names have in common at their beginnings."""
    return sum(1 for _ in takewhile(lambda pair: pair[0] == pair[1], zip(one, two, strict=False)))


def variables_of(path: Path, top: Path) -> Workspace:
    """What scripts assign: those in the nearest folder around the model that has any, recursively.

    Scripts whose names begin as the model's does come later, and those of the repository that name
    the model last.
    """
    found = Workspace({}, guess=True)
    name = re.compile(rf"\b{re.escape(path.stem)}\b")
    folder = path.parent
    while folder != top and not any(place.is_relative_to(folder) for place, _ in _scripts(top)):
        folder = folder.parent
    own = [
        (name.search(text) is not None, _alike(place.stem, path.stem), place, text)
        for place, text in _scripts(top)
    ]
    for named, _, place, text in sorted(own):
        if named or place.is_relative_to(folder):
            try:
                assignments(text, place.parent, found)
            except RavenbrickError:  # a .mat file that cannot be read
                continue
    return found


def _too_long(*_: object) -> None:
    raise _TooLongError(f"more than {_PROCESSOR_SECONDS} s of a processor")


def _failure(use: Callable[[], object]) -> str:
    """Why a use fails within the time; empty if it does not."""
    signal.signal(signal.SIGVTALRM, _too_long)
    signal.setitimer(signal.ITIMER_VIRTUAL, _PROCESSOR_SECONDS)
    try:
        use()
    except (DesignError, OverflowError, ValueError, _TooLongError) as error:
        return f"{getattr(error, 'detail', '') or error}"
    finally:
        signal.setitimer(signal.ITIMER_VIRTUAL, 0)
    return ""


@dataclass
class Outcome:
    """What became of one model; `survey` is None for one that is not read."""

    owner: str
    group: int | None
    survey: Survey | None
    no_run: str
    no_code: str

    @property
    def outside(self) -> bool:
        """Whether it uses what no diagram of signals has."""
        return self.survey is not None and self.survey.outside > 0


def outcome_of(path: Path, folder: Path) -> Outcome:
    """Read a model, simulate it and make C of it, each alone."""
    top = folder / Path(*path.relative_to(folder).parts[:2])
    owner = top.relative_to(folder).as_posix()
    group = group_of(owner, path)
    try:
        given = variables_of(path, top)
        survey = survey_simulink(path, libraries=[top], variables=given)
    except RavenbrickError as error:
        return Outcome(owner, group, None, f"{error}", f"{error}")
    if survey.refusals or group is None:
        refused = sorted(survey.refusals, key=lambda one: not one.outside)
        why = f"({refused[0].kind}): {refused[0].reason}" if refused else "not tried"
        return Outcome(owner, group, survey, why, why)
    source = ModelSource(path, 0.01, given, (top,))
    network = source.network()
    source = ModelSource(path, base_rate(network, 0.0) or 0.01, given, (top,))
    endless = network.settings.get("StopTime", "").lower() == "inf"
    return Outcome(
        owner, group, survey,
        _failure(lambda: simulate(source, _STOP if endless else None)),
        _failure(lambda: generate_c(source.imported().diagram, only_used=True)),
    )  # fmt: skip


@dataclass
class _Count:
    """Models and blocks of some outcomes."""

    outcomes: list[Outcome] = field(default_factory=list)

    def _inside(self) -> list[Outcome]:
        return [one for one in self.outcomes if not one.outside]

    @property
    def surveys(self) -> list[Survey]:
        """Of the models that are read."""
        return [one.survey for one in self.outcomes if one.survey is not None]

    def cells(self) -> list[str]:
        """Number, read, outside; of the others blocks; simulated and C, of them and of all."""
        inside = self._inside()
        own = [one.survey for one in inside if one.survey is not None]
        blocks, good = sum(s.blocks for s in own), sum(s.supported for s in own)
        runs = sum(not one.no_run for one in inside)
        code = sum(not one.no_code for one in inside)
        most, every = max(len(inside), 1), max(len(self.outcomes), 1)
        return [
            f"{len(self.outcomes)}", f"{len(self.surveys)}", f"{len(self.outcomes) - len(inside)}",
            f"{good:,} of {blocks:,} ({good / max(blocks, 1):.1%})",
            *(f"{n} of {len(inside)} ({n / most:.0%}; {n / every:.0%})" for n in (runs, code)),
        ]  # fmt: skip

    def text(self) -> str:
        """What is imported of all blocks, and of those that signals can express."""
        blocks, good = (sum(getattr(s, n) for s in self.surveys) for n in ("blocks", "supported"))
        outside = sum(s.outside for s in self.surveys)
        return (
            f"{good:,} of {blocks:,} blocks are imported ({good / max(blocks, 1):.1%}); "
            f"{outside:,} lie outside (charts, S-functions, physical modelling, devices, "
            f"toolboxes), and of the others {good / max(blocks - outside, 1):.1%} are imported"
        )


def reason_of(text: str) -> str:
    """A failure's kind."""
    return next((name for mark, name in _REASONS if mark in text), "other reasons")


def _reasons(outcomes: Sequence[Outcome]) -> Iterator[str]:
    """Rows of why models are not simulated, and why no C is made, the most frequent first."""
    runs, code = Counter[str](), Counter[str]()
    for one in outcomes:
        for found, text in ((runs, one.no_run), (code, one.no_code)):
            if text:
                found["files that are no models" if one.survey is None else reason_of(text)] += 1
    for name, count in (runs | code).most_common():
        yield f"| {name} | {runs[name]} | {code[name]} |" if count else ""


def simulink_page(folder: Path, last: str) -> tuple[str, int, int]:
    """The page after the `last` one, the number of models and how many were read."""
    outcomes, seen = [], set()
    paths = models_in(folder)
    for path in paths:
        digest = hashlib.sha256(path.read_bytes()).digest()
        if digest not in seen:  # no copy
            seen.add(digest)
            outcomes.append(outcome_of(path, folder))
    owners = {Path(*p.relative_to(folder).parts[:2]).as_posix() for p in paths}
    rows = []
    for owner in sorted(owners):
        cells = _Count([one for one in outcomes if one.owner == owner]).cells()
        if owner in THE_32:
            cells[-2:] = ["not tried", "not tried"]
        rows.append(f"| {owner} | {' | '.join(cells)} | {today()} |")
    kept = kept_rows(last, lambda owner: owner not in owners)
    totals = _totals(outcomes)
    if kept:  # sums of fewer models say less
        totals = last.partition(f"{TOTALS}\n\n")[2].partition("\n\n## Repositories")[0].splitlines()
    known = _Count([one for one in outcomes if one.owner in THE_32])
    lines = _lines(totals, known, sorted([*rows, *kept]))
    return "\n".join(lines), len(outcomes), len(_Count(outcomes).surveys)


def _totals(outcomes: list[Outcome]) -> list[str]:
    every = _Count(outcomes)
    head = "| Models | Number | Read | Outside | Blocks of the others | Simulated | C |"
    groups = [_Count([o for o in outcomes if o.group == place]) for place in range(len(GROUPS))]
    tried = [one for one in outcomes if one.group is not None]
    return [
        f"Counted on {today()}. {len(every.surveys)} of {len(outcomes)} models are read: "
        f"{every.text()}.",
        "",
        head,
        "|---|---:|---:|---:|---:|---:|---:|",
        *(f"| {name} | {' | '.join(group.cells())} |"
          for name, group in zip(GROUPS, groups, strict=True) if group.outcomes),
        "",
        "The first share under *Simulated* and *C* is that of the models without blocks outside,",
        "the second that of all.",
        "",
        "| Why models fail | Not simulated | No C |",
        "|---|---:|---:|",
        *_reasons(tried),
    ]  # fmt: skip


def _lines(totals: list[str], known: _Count, rows: list[str]) -> list[str]:
    """The page around its figures."""
    return [
        "# Public Simulink models",
        "",
        "Generated by `python -m verification.control.public_models`; do not edit.",
        "Each block of a model is imported, or refused with its path and the reason. Variables of",
        "the workspace are those that the model's callbacks assign, the scripts in the nearest",
        "folder around it that has any, and scripts of its repository that name the model; others",
        "are 1. A library link counts as one block and is refused if any block inside it is",
        "refused. Libraries also count as models, with 0 at their open inputs. *Simulated* models",
        "run to their stop time (10 s if that is infinite) with their continuous blocks, within",
        f"{_PROCESSOR_SECONDS} s of a processor; from models with *C* the whole becomes C. The "
        "sample time is",
        "that of the model's blocks, 10 ms where none is stated. Models *outside* use what only a",
        "licence has: physical modelling, charts, compiled S-functions, devices, toolboxes.",
        "Copies are left out. None of the models is part of this project. Where only some of them",
        "are at hand, the rows of the others and the totals stay as they were, with their date.",
        "",
        f"The {len(known.outcomes)} of {' and '.join(THE_32)}, of whose blocks 45 types make up "
        f"99 %, on {today()}: {known.text()}.",
        "",
        TOTALS,
        "",
        *totals,
        "",
        "## Repositories",
        "",
        "| Repository | Models | Read | Outside | Blocks of the others | Simulated | C | Date |",
        "|---|---:|---:|---:|---:|---:|---:|---|",
        *rows,
        "",
    ]


def main() -> int:
    """Write the page."""
    folder = os.environ.get("RAVENBRICK_SLX_MODELS")
    if folder is None:
        print("RAVENBRICK_SLX_MODELS must name a folder of models")
        return 2
    path = REFERENCE / "simulink-models.md"
    page, count, read = simulink_page(Path(folder), path.read_text(encoding="utf-8"))
    path.write_text(page, encoding="utf-8")
    print(f"{read} of {count} models read")
    return 0


if __name__ == "__main__":
    sys.exit(main())
