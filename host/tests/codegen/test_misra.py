# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Cppcheck's MISRA C:2012 rules on the generated C, and how far it can be traced to blocks."""

from __future__ import annotations

import re
import subprocess
from collections import Counter
from pathlib import Path

import pytest
from verification.support.codegen.block_programs import all_models, fixed_program
from verification.support.codegen.misra import (
    controllers,
    cppcheck,
    judge,
    write_imported,
    write_models,
    write_vehicle,
)

from ravenbrick.codegen import generate_c
from ravenbrick.model import Diagram, Gain, Inport, Outport, UnitDelay

FIGURE_5 = Path(__file__).resolve().parents[3] / "examples" / "paper" / "models" / "figure5.slx"

# What the form for importing languages adds: types and limits for the application to use.
DECLARATION_RULES = {"2.3", "2.5", "21.1"}


def clean(folder: Path) -> bool:
    """No finding, with the deviations that the comments in the code state, and no other."""
    done = judge(folder, "--inline-suppr")
    return done.findings == Counter() and done.interface == 0


@pytest.mark.long("40 programs through the MISRA rules")
def test_every_block_s_c_has_no_finding(tmp_path: Path) -> None:
    """All blocks in single precision and in fixed point, those with helpers also in double."""
    cppcheck()
    wide = {"wide_quantiser", "wide_look_up"}
    models = {n: m for n, m in all_models().items() if n in wide or not n.startswith("wide_")}
    write_models(models, tmp_path)
    assert len(list(tmp_path.glob("*.c"))) > 40
    assert clean(tmp_path)


@pytest.mark.parametrize("name", ["vehicle", "paper"])
def test_the_controllers_have_no_finding(name: str, tmp_path: Path) -> None:
    """As generated, with the model's own rtwtypes.h."""
    cppcheck()
    generate_c(controllers()[name], only_used=True).write(tmp_path)
    assert clean(tmp_path)


def test_the_vehicle_s_own_files_have_no_finding(tmp_path: Path) -> None:
    """The C that lies in examples/vehicle/generated, as it is built; and it is traceable."""
    cppcheck()
    write_vehicle(tmp_path)
    assert clean(tmp_path)
    text = "".join((tmp_path / name).read_text() for name in ("functional.c", "functional.h"))
    assert references_per_100_lines(text) >= 35


def test_the_deviation_is_stated_at_the_interface_only(tmp_path: Path) -> None:
    """Without the comments rule 8.7 is found at the two functions that only Ada calls."""
    cppcheck()
    write_vehicle(tmp_path)
    done = judge(tmp_path)
    assert (done.findings, done.interface) == (Counter(), 2)


HEADER = "extern float speed;\nextern void control_step(void);\n"
STEP = "float speed;\nvoid control_step(void)\n{\n  speed = speed + 1.0F;\n}\n"
TABLE = "typedef void (*entry_T)(void);\nextern const entry_T entry;\n"


@pytest.mark.parametrize(
    ("before", "after", "found"),
    [
        ('#include "control.h"\n', "", {"8.7"}),
        ("", "", {"8.4"}),
        (f'#include "control.h"\n{TABLE}', "const entry_T entry = &control_step;\n", {"8.7"}),
        # What rule 8.5 forbids: the checker does not see it, and takes it for a reference.
        ('#include "control.h"\nextern void control_step(void);\n', "", set()),
    ],
    ids=["declared", "not declared", "table of entry points", "declared twice"],
)
def test_each_form_of_an_entry_point_without_a_c_caller_breaks_a_rule(
    before: str, after: str, found: set[str], tmp_path: Path
) -> None:
    """The outermost function of a library is one that no C refers to."""
    cppcheck()
    (tmp_path / "control.h").write_text(f"#ifndef CONTROL_H\n#define CONTROL_H\n{HEADER}#endif\n")
    (tmp_path / "control.c").write_text(f"{before}{STEP}{after}")
    options = ["--addon=misra", "--enable=style", "--template={id}", "--quiet"]
    command = [cppcheck(), *options, str(tmp_path / "control.c")]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    rules = {line.rpartition("-")[2] for line in done.stderr.splitlines() if "misra" in line}
    assert rules & {"8.4", "8.7"} == found


def test_variables_of_one_rate_are_declared_in_its_guard(tmp_path: Path) -> None:
    """A gain in every fourth step; in fixed point a slow sum before its limits."""
    cppcheck()
    slow = Diagram("slow", 0.01)
    gain = Gain("Half", gain=0.5, sample_time=0.04)
    level = UnitDelay("Level", sample_time=0.04)
    slow.connect_chain(*map(slow.add, (Inport("In"), gain, level, Outport("Out"))))
    write_models({"slow": slow, "average": fixed_program("slow_average")}, tmp_path)
    assert clean(tmp_path)


def test_an_imported_model_has_no_finding(tmp_path: Path) -> None:
    """The paper's figure 5, without any other C beside it."""
    cppcheck()
    assert write_imported([FIGURE_5], [], tmp_path) == 1
    assert clean(tmp_path / "0")


@pytest.mark.parametrize("name", ["vehicle", "paper"])
def test_the_form_for_importing_languages_only_declares_more(name: str, tmp_path: Path) -> None:
    """Layout checks and unused types break three rules about declarations, and no other."""
    cppcheck()
    generate_c(controllers()[name]).write(tmp_path)
    assert set(judge(tmp_path).findings) == DECLARATION_RULES


def test_the_checker_does_look_at_the_code(tmp_path: Path) -> None:
    """A shift of a negative number in the step function is found, and nothing else."""
    cppcheck()
    generate_c(controllers()["paper"], only_used=True).write(tmp_path)
    source = tmp_path / "functional.c"
    text = source.read_text()
    assert "(int16_T)(Saturated / 32768)" in text
    source.write_text(text.replace("(int16_T)(Saturated / 32768)", "Saturated >> 15"))
    assert judge(tmp_path).findings == Counter({"10.1": 1})


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
