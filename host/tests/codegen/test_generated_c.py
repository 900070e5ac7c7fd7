# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The generated C against the diagram's own simulation, bit for bit, on host and ARM."""

from __future__ import annotations

import ctypes
from pathlib import Path

import numpy as np
import pytest
from verification.support.codegen.c_build import ARM, WARNINGS, arm_image, host_library, run
from verification.support.codegen.emulation import run_on_arm

from ravenbrick.codegen import check_program, generate_c, random_vectors
from ravenbrick.control import DiscretePi, pi_diagram
from ravenbrick.errors import DesignError
from ravenbrick.model import (
    Constant,
    Conversion,
    DataType,
    Diagram,
    DiscreteTransferFunction,
    Gain,
    Inport,
    IntegrationMethod,
    Outport,
    Sum,
    UnitDelay,
)

PI = DiscretePi(0.314445, 0.032221, 0.004, IntegrationMethod.FORWARD_EULER)
STEPS = 5000


def controller(method: IntegrationMethod = IntegrationMethod.FORWARD_EULER) -> Diagram:
    """The vehicle's kind of controller."""
    return pi_diagram(DiscretePi(0.314445, 0.032221, 0.004, method), 8.0, 0.037)


def many_blocks() -> Diagram:
    """One of every other block, with a double-precision branch."""
    diagram = Diagram("mixture", 0.01)
    source = diagram.add(Inport("In"))
    wide = diagram.add(Conversion("Wide", DataType.REAL64, from_type=DataType.REAL32))
    filtered = diagram.add(
        DiscreteTransferFunction(
            "Filter", DataType.REAL64, None, (0.02, 0.04, 0.02), (1.0, -1.56, 0.64)
        )
    )
    narrow = diagram.add(Conversion("Narrow"))
    memory = diagram.add(UnitDelay("Memory", initial=-0.5))
    older = diagram.add(UnitDelay("Older"))
    offset = diagram.add(Constant("Offset", value=-0.1))
    total = diagram.add(Sum("Total", signs="+-++"))
    scale = diagram.add(Gain("Scale", gain=1e-9))
    diagram.connect_chain(source, wide, filtered, narrow, total, scale, diagram.add(Outport("Out")))
    diagram.connect_chain(source, memory, older)
    diagram.connect(memory, total, 1)
    diagram.connect(older, total, 2)
    diagram.connect(offset, total, 3)
    return diagram


DIAGRAMS = {
    **{method.name.lower(): controller(method) for method in IntegrationMethod},
    "mixture": many_blocks(),
}


def write(diagram: Diagram, folder: Path, steps: int, seed: int) -> str:
    """Write the C and a check of `steps` random steps; returns the model's name."""
    generate_c(diagram).write(folder)
    text = check_program(random_vectors(diagram, steps, seed))
    (folder / "check.c").write_text(text)
    return diagram.name


@pytest.mark.parametrize("level", ["-O0", "-O2", "-O3"])
@pytest.mark.parametrize("name", DIAGRAMS)
def test_the_c_on_the_host_equals_the_simulation_bit_for_bit(
    name: str, level: str, tmp_path: Path
) -> None:
    """5000 random steps, no bit different, with all warnings as errors."""
    model = write(DIAGRAMS[name], tmp_path, STEPS, seed=7)
    library = host_library(tmp_path, f"{model}.c", "check.c", *_ports(model, tmp_path), level=level)
    getattr(library, f"{model}_check")()
    assert ctypes.c_uint32.in_dll(library, f"{model}_check_steps").value == STEPS
    assert ctypes.c_uint32.in_dll(library, f"{model}_check_failures").value == 0


def _ports(model: str, folder: Path) -> tuple[str, ...]:
    """The variables that the application defines."""
    (folder / "ports.c").write_text(
        f'#include "{model}.h"\n'
        f"ExternalInputs_{model} {model}_U;\nExternalOutputs_{model} {model}_Y;\n"
    )
    return ("ports.c",)


def test_the_check_finds_a_wrong_bit(tmp_path: Path) -> None:
    """With another gain in the C every step that is not limited or zero differs."""
    model = write(controller(), tmp_path, 500, seed=3)
    source = tmp_path / "functional.c"
    source.write_text(source.read_text().replace("0.314445F", "0.31444502F"))
    library = host_library(tmp_path, "functional.c", "check.c", *_ports(model, tmp_path))
    library.functional_check()
    assert ctypes.c_uint32.in_dll(library, "functional_check_failures").value > 100


class _Pair(ctypes.Structure):
    _fields_ = (("Input_Voltage", ctypes.c_float), ("Real_Voltage", ctypes.c_float))


def test_two_instances_and_the_paper_form_do_not_disturb_each_other(tmp_path: Path) -> None:
    """Two work areas and functional_step() on its own variables each follow their own inputs."""
    generate_c(controller()).write(tmp_path)
    library = host_library(tmp_path, "functional.c", *_ports("functional", tmp_path))
    vectors = [random_vectors(controller(), 200, seed) for seed in (1, 2, 3)]
    works = [ctypes.c_float(99.0), ctypes.c_float(-99.0)]
    for work in works:
        library.functional_initialize_instance(ctypes.byref(work))
    library.functional_initialize()
    inputs = _Pair.in_dll(library, "functional_U")
    output = ctypes.c_float.in_dll(library, "functional_Y")
    for step in range(200):
        for work, own in zip(works, vectors, strict=False):
            result, given = ctypes.c_float(), _Pair(*map(float, own.inputs[step]))
            library.functional_step_instance(
                ctypes.byref(work), ctypes.byref(given), ctypes.byref(result)
            )
            assert np.float32(result.value) == own.outputs[step, 0]
        inputs.Input_Voltage, inputs.Real_Voltage = map(float, vectors[2].inputs[step])
        library.functional_step()
        assert np.float32(output.value) == vectors[2].outputs[step, 0]


def test_the_supply_limit_is_a_tunable_of_all_instances(tmp_path: Path) -> None:
    """functional_P.Saturation, the fourth parameter, limits from the next step on."""
    generate_c(controller()).write(tmp_path)
    library = host_library(tmp_path, "functional.c", *_ports("functional", tmp_path))
    parameters = (ctypes.c_float * 4).in_dll(library, "functional_P")
    assert parameters[3] == 8.0
    parameters[3] = 1.25
    work, result = ctypes.c_float(), ctypes.c_float()
    library.functional_initialize_instance(ctypes.byref(work))
    library.functional_step_instance(
        ctypes.byref(work), ctypes.byref(_Pair(12.0, 0.0)), ctypes.byref(result)
    )
    assert result.value == 1.25


def test_the_same_diagram_gives_the_same_bytes_and_another_another_digest() -> None:
    """No date, no path; the digest follows the gains."""
    first, second = generate_c(controller()), generate_c(controller())
    assert first.files == second.files
    assert generate_c(controller(IntegrationMethod.TUSTIN)).digest != first.digest
    for name in ("functional.c", "functional.h"):
        assert first.digest in first.files[name]
        assert "do not edit" in first.files[name]


def test_every_statement_names_its_block() -> None:
    """Each block that computes something stands in a comment of the C."""
    diagram = controller()
    text = generate_c(diagram).files["functional.c"]
    for block in diagram.blocks:
        if not isinstance(block, Inport):
            assert f": '<Root>/{block.name}' */" in text


def test_ports_and_blocks_may_have_the_names_of_the_step_s_own_variables(tmp_path: Path) -> None:
    """Fields of structures and local variables of the step function do not meet."""
    diagram = Diagram("words", 0.004)
    chain = (Inport("u"), Gain("work", gain=2.0), Gain("while", gain=3.0), Outport("y"))
    diagram.connect_chain(*map(diagram.add, chain))
    generate_c(diagram).write(tmp_path)
    (tmp_path / "ports.c").write_text(
        '#include "words.h"\nExternalInputs_words words_U;\nExternalOutputs_words words_Y;\n'
    )
    library = host_library(tmp_path, "words.c", "ports.c")
    ctypes.c_float.in_dll(library, "words_U").value = 1.5
    library.words_step()
    assert ctypes.c_float.in_dll(library, "words_Y").value == 9.0


def test_a_word_of_c_cannot_name_a_port() -> None:
    """The message names the block."""
    diagram = Diagram("words", 0.004)
    source = diagram.add(Inport("while"))
    diagram.connect_chain(source, diagram.add(Gain("Double")), diagram.add(Outport("Out")))
    with pytest.raises(DesignError, match="'while' is a word of C"):
        generate_c(diagram)


def test_the_c_needs_no_library_but_the_compiler_s(tmp_path: Path) -> None:
    """Compiled for the brick it asks for soft-float routines and its own variables only."""
    generate_c(controller()).write(tmp_path)
    run("arm-none-eabi-gcc", "-O2", *ARM, *WARNINGS, "-c", tmp_path / "functional.c", "-o",
        tmp_path / "functional.o")  # fmt: skip
    listing = run("arm-none-eabi-nm", "-u", tmp_path / "functional.o")
    needed = {line.split()[-1] for line in listing.splitlines()}
    assert {name for name in needed if not name.startswith("__aeabi_f")} == {
        "functional_U",
        "functional_Y",
    }
    text, data, bss = _sizes(tmp_path / "functional.o")
    assert text <= 450
    assert (data, bss) == (16, 4)


def _sizes(path: Path) -> tuple[int, int, int]:
    values = run("arm-none-eabi-size", path).splitlines()[1].split()
    return int(values[0]), int(values[1]), int(values[2])


def test_an_application_with_instances_links_without_the_paper_s_variables(tmp_path: Path) -> None:
    """With sections collected, functional_U and functional_Y need not exist."""
    write(controller(), tmp_path, 10, seed=1)
    image = arm_image(tmp_path, "functional_check", "functional.c", "check.c")
    symbols = run("arm-none-eabi-nm", image)
    assert "functional_step_instance" in symbols
    assert "functional_U" not in symbols


def test_the_paper_form_links_with_inputs_and_outputs_defined_elsewhere(tmp_path: Path) -> None:
    """functional_step with functional_U and functional_Y of another unit."""
    generate_c(controller()).write(tmp_path)
    image = arm_image(tmp_path, "functional_step", "functional.c", *_ports("functional", tmp_path))
    symbols = run("arm-none-eabi-nm", image)
    for name in ("functional_U", "functional_Y", "functional_step", "functional_DW"):
        assert f" {name}" in symbols


@pytest.mark.parametrize("options", [("-marm",), ("-mthumb",)], ids=["arm", "thumb"])
@pytest.mark.parametrize("name", DIAGRAMS)
def test_the_c_on_the_arm_equals_the_simulation_bit_for_bit(
    name: str, options: tuple[str, ...], tmp_path: Path
) -> None:
    """1000 random steps on an emulated ARM with the soft-float library of the brick."""
    emulation = pytest.importorskip(
        "unicorn", reason="the Python package unicorn (an ARM emulator) is not installed"
    )
    model = write(DIAGRAMS[name], tmp_path, 1000, seed=11)
    image = arm_image(tmp_path, f"{model}_check", f"{model}.c", "check.c", options=options)
    values = run_on_arm(emulation, image, f"{model}_check")
    assert values(f"{model}_check_steps") == 1000
    assert values(f"{model}_check_failures") == 0
