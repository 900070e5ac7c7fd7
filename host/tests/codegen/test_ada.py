# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Generated Ada against the simulation, bit for bit, contracts tested as it runs on an ARM."""

from __future__ import annotations

import re
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest
from verification.support.codegen.block_programs import all_models
from verification.support.codegen.c_build import ada_object, arm_image, run
from verification.support.codegen.emulation import run_on_arm
from verification.support.codegen.fixed_point_cases import CASES, slow_limit
from verification.support.codegen.paper_pi import fixed_pi, paper_pi
from verification.support.codegen.random_diagrams import fixed_form, random_diagram

from ravenbrick.codegen import check_program, generate_ada, generate_c, random_vectors
from ravenbrick.errors import DesignError
from ravenbrick.model import Diagram, FixedPoint, Gain, Inport, Outport, Rounding
from ravenbrick.model.program import Program

STEPS = 60
COMPILER = "arm-linux-gnueabi-gcc-12"

pytestmark = pytest.mark.skipif(
    shutil.which(COMPILER) is None, reason=f"the Ada compiler {COMPILER} is not installed"
)


def run_checks(
    models: dict[str, Diagram | Program | FixedPoint], folder: Path
) -> Callable[[str], int]:
    """Generate, compile and run all models' checks; returns a reader of variables."""
    emulation = pytest.importorskip(
        "unicorn", reason="the Python package unicorn (an ARM emulator) is not installed"
    )
    objects, files = [], []
    for name, source in models.items():
        program = source.program if isinstance(source, FixedPoint) else source
        generate_c(program).write(folder)
        (folder / f"{name}.c").unlink()
        for file in generate_ada(source, c_names=True).write(folder):
            if file.suffix == ".adb":
                objects.append(ada_object(folder, file.name))
        vectors = random_vectors(program, STEPS, seed=13)
        (folder / f"{name}_check.c").write_text(check_program(vectors))
        files.append(f"{name}_check.c")
    traps = sorted(
        name
        for file in objects
        for name in run("arm-none-eabi-nm", "-u", file).split()
        if name.startswith(("__gnat_rcheck", "system__", "__gnat_raise"))
    )
    lines = [
        f"extern void {name}(void);\nvoid {name}(void) {{ __builtin_trap(); }}"
        for name in dict.fromkeys([*traps, "__aeabi_unwind_cpp_pr0"])
    ]
    calls = "".join(f"  {name}_check();\n" for name in models)
    lines += [f"extern void {name}_check(void);" for name in models]
    lines.append(f"extern void all_checks(void);\nvoid all_checks(void)\n{{\n{calls}}}\n")
    (folder / "all.c").write_text("\n".join(lines))
    image = arm_image(folder, "all_checks", "all.c", *files, extra=tuple(objects))
    return run_on_arm(emulation, image, "all_checks")


def test_all_blocks_in_ada_equal_their_simulation(tmp_path: Path) -> None:
    """Single precision and fixed point, double where it differs; no check, no contract fails."""
    wide = {"wide_quantiser", "wide_look_up", "wide_sine", "wide_pid"}
    models: dict[str, Diagram | Program | FixedPoint] = {
        n: m for n, m in all_models().items() if n in wide or not n.startswith("wide_")
    }
    value = run_checks(models, tmp_path)
    for name in models:
        assert value(f"{name}_check_steps") == STEPS, name
        assert value(f"{name}_check_failures") == 0, name


@pytest.mark.parametrize("name", [*CASES, "slow_limit"])
def test_fixed_point_controllers_in_ada_equal_their_simulation(name: str, tmp_path: Path) -> None:
    """Both ways of rounding, with the proved ranges as checked types; a limit at a slower rate."""
    fixed = slow_limit(32) if name == "slow_limit" else CASES[name]
    program = fixed.program
    value = run_checks({program.name: fixed}, tmp_path)
    assert value(f"{program.name}_check_steps") == STEPS
    assert value(f"{program.name}_check_failures") == 0


def test_a_changed_statement_is_found(tmp_path: Path) -> None:
    """The comparison can fail: a sum becomes a difference."""
    code = generate_ada(paper_pi(), c_names=True)
    text = code.files["functional.adb"]
    assert "Demand := Proportional + Integral;" in text
    folder = tmp_path / "changed"
    wrong = text.replace("Proportional + Integral;", "Proportional - Integral;")
    folder.mkdir()
    generate_c(paper_pi()).write(folder)
    (folder / "functional.ads").write_text(code.files["functional.ads"])
    (folder / "functional.adb").write_text(wrong)
    ada = ada_object(folder, "functional.adb", checks=False)
    vectors = random_vectors(paper_pi(), STEPS, seed=13)
    (folder / "functional_check.c").write_text(check_program(vectors))
    image = arm_image(folder, "functional_check", "functional_check.c", extra=(ada,))
    value = run_on_arm(pytest.importorskip("unicorn"), image, "functional_check")
    assert value("functional_check_failures") > STEPS / 2


def test_the_fixed_point_ada_needs_no_library_and_no_wide_product(tmp_path: Path) -> None:
    """Native types compile to 32-bit integer code as small as the C's."""
    for rounding in Rounding:
        generate_ada(fixed_pi(rounding)).write(tmp_path)
        target = ada_object(tmp_path, "functional.adb", checks=False)
        assert run("arm-none-eabi-nm", "-u", target).split() == []
        rows = [line.split() for line in run("arm-none-eabi-nm", "-S", target).splitlines()]
        sizes = {row[3]: int(row[1], 16) for row in rows if len(row) == 4}
        assert 60 < sizes["functional__step"] <= 160


def test_a_constant_of_a_branch_that_is_never_taken_compiles(tmp_path: Path) -> None:
    """The random diagram has a table whose input never leaves its middle."""
    program = fixed_form(random_diagram(101, fixed=True))
    assert program is not None
    files = generate_ada(program).write(tmp_path)
    ada_object(tmp_path, next(file.name for file in files if file.suffix == ".adb"), checks=False)


def test_the_contract_names_what_is_proved() -> None:
    """Ranges of fixed-point state and output; the limit that a saturated output keeps."""
    fixed = generate_ada(fixed_pi()).files["functional.ads"]
    assert "Integral_DSTATE : Sfix32_En26 range -9.0 .. 9.0;" in fixed
    assert "Kp : constant Sfix16_En15 := 0.361083984375;" in fixed
    assert "Global => null" in fixed
    single = generate_ada(paper_pi()).files["functional.ads"]
    assert "Pre => Parameters.Limit >= 0.0" in single
    assert "Post => not (Outputs.Correctedvoltage > Parameters.Limit" in single
    assert "Export" not in fixed + single


def test_every_statement_names_its_block() -> None:
    """One comment per statement, as in the C."""
    program = paper_pi().lower()
    body = generate_ada(program).files["functional.adb"].partition("begin")[2]
    named = re.findall(r"--  [\w ]+: (\w+)", body)
    assert named == [s.block for s in program.statements]


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("Bad__Name", "is not an Ada name"),
        ("Tail_", "is not an Ada name"),
        ("Work", "has a meaning"),
    ],
)
def test_a_name_that_ada_does_not_know_is_refused(name: str, message: str) -> None:
    """By name, before anything is written."""
    diagram = Diagram("model", 0.01)
    source, gain = diagram.add(Inport("In")), diagram.add(Gain(name, gain=2.0))
    diagram.connect_chain(source, gain, diagram.add(Outport("Out")))
    with pytest.raises(DesignError, match=message):
        generate_ada(diagram)
