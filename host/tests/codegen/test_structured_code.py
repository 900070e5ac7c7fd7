# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""State machines, delay lines, rates and systems of several outputs, as C and Ada show them."""

from __future__ import annotations

import ctypes
import re
from pathlib import Path

import control
import numpy as np
import pytest
from verification.support.codegen.c_build import ada_object, host_library

from ravenbrick.codegen import check_program, generate_ada, generate_c, random_vectors
from ravenbrick.model import (
    Delay,
    Diagram,
    DiagramError,
    DiscreteIntegrator,
    Execution,
    FixedPointOptions,
    Gain,
    Inport,
    MachineState,
    Outport,
    Pulse,
    StateMachine,
    Sum,
    Transition,
    UnitDelay,
    linearise,
    state_space_block,
    to_fixed_point,
)

STATES = (MachineState("idle", 0.0), MachineState("moving", 1.0), MachineState("stopped", 2.0))
MOVES = (
    Transition("idle", "moving", 0, ">=", 0.5),
    Transition("moving", "stopped", 0, "<", 0.2, after=3),
    Transition("stopped", "idle", None, after=10),
)


def mixed() -> Diagram:
    """A state machine and a delay at the base rate, two blocks that run in every fourth step."""
    diagram = Diagram("mixed", 0.01)
    source, sink = diagram.add(Inport("In")), diagram.add(Outport("Out"))
    gate = diagram.add(StateMachine("Gate", machine_states=STATES, transitions=MOVES))
    slow = diagram.add(Gain("Slow", gain=0.5, sample_time=0.04))
    level = diagram.add(UnitDelay("Level", sample_time=0.04))
    total = diagram.add(Sum("Total"))
    late = diagram.add(Delay("Late", length=20))
    diagram.connect(source, gate)
    diagram.connect_chain(source, slow, level)
    diagram.connect(gate, total, 0)
    diagram.connect(level, total, 1)
    diagram.connect_chain(total, late, sink)
    return diagram


def test_a_variable_of_one_rate_is_declared_inside_its_guard() -> None:
    """In C at the beginning of the guard's block, in Ada in a block statement of its own."""
    source = generate_c(mixed()).files["mixed.c"]
    step = source[source.index("void mixed_step_instance") :]
    head, guard = step.split("_steps_count <= 0) {\n", 1)
    assert "real32_T Total" in head
    assert "real32_T Slow" not in head
    assert guard.startswith("    real32_T Slow;")
    body = generate_ada(mixed()).files["mixed.adb"]
    declared, statements = body.split("procedure Step")[1].split("   begin\n", 1)
    assert "Total : Float;" in declared
    assert "Slow : Float;" not in declared
    assert "declare\n            Slow : Float;\n         begin\n" in statements


def test_a_state_machine_is_a_switch_over_named_states() -> None:
    """With an enumeration in the header; in Ada a case statement."""
    files = generate_c(mixed()).files
    assert "mixed_Gate_idle,\n  mixed_Gate_moving,\n  mixed_Gate_stopped" in files["mixed.h"]
    assert re.findall(r"case (\w+):", files["mixed.c"]) == [
        "mixed_Gate_idle", "mixed_Gate_moving", "mixed_Gate_stopped",
    ]  # fmt: skip
    body = generate_ada(mixed()).files["mixed.adb"]
    assert "case Work.Gate_DSTATE is" in body
    assert "when Gate_Moving =>" in body


def test_a_delay_line_stores_one_sample_per_step() -> None:
    """At the place of the oldest, whatever the length."""
    text = generate_c(mixed()).files["mixed.c"]
    assert text.count("work->Late_DSTATE[work->Late_DSTATE_oldest] =") == 1
    assert "Late_DSTATE2" not in text


def test_each_rate_has_one_guard() -> None:
    """What is read inside of it only is a local variable."""
    files = generate_c(mixed()).files
    assert files["mixed.c"].count("if (work->every_4_steps_count <= 0)") == 1
    assert "Slow_held" not in files["mixed.h"]
    assert "Level_held" in files["mixed.h"]


def test_a_slow_loop_is_computed_although_its_states_change_at_the_end(tmp_path: Path) -> None:
    """The input of a slow delay comes from a block of the base rate behind it."""
    diagram = Diagram("loop", 0.01)
    source, sink = diagram.add(Inport("In")), diagram.add(Outport("Out"))
    total = diagram.add(Sum("Total"))
    memory = diagram.add(UnitDelay("Memory", sample_time=0.02))
    doubled = diagram.add(Gain("Doubled", gain=2.0, sample_time=0.02))
    diagram.connect(source, total, 0)
    diagram.connect_chain(memory, doubled)
    diagram.connect(doubled, total, 1)
    diagram.connect(total, memory)
    diagram.connect(total, sink)
    execution = Execution(diagram)
    outputs = [float(execution.step({"In": 1.0})["Out"]) for _ in range(6)]
    assert outputs == [1.0, 1.0, 3.0, 3.0, 7.0, 7.0]
    assert failures(diagram, tmp_path) == 0


def failures(diagram: Diagram, folder: Path) -> int:
    """Steps in which the C differs from the simulation."""
    name = diagram.name
    generate_c(diagram).write(folder)
    ports = f'#include "{name}.h"\nExternalInputs_{name} {name}_U;\n'
    (folder / "ports.c").write_text(f"{ports}ExternalOutputs_{name} {name}_Y;\n")
    (folder / "check.c").write_text(check_program(random_vectors(diagram, 300, seed=2)))
    library = host_library(folder, f"{name}.c", "ports.c", "check.c")
    getattr(library, f"{name}_check")()
    assert ctypes.c_uint32.in_dll(library, f"{name}_check_steps").value == 300
    return ctypes.c_uint32.in_dll(library, f"{name}_check_failures").value


def test_a_diagram_of_sources_needs_no_inport(tmp_path: Path) -> None:
    """The structure of inputs has a field that nothing reads; the Ada is the same."""
    diagram = Diagram("source", 0.01)
    diagram.connect_chain(diagram.add(Pulse("P", period=7, width=3)), diagram.add(Outport("Out")))
    assert failures(diagram, tmp_path) == 0
    generate_ada(diagram).write(tmp_path)
    ada_object(tmp_path, "source.adb")


def test_the_mixed_diagram_runs_as_simulated(tmp_path: Path) -> None:
    """Every bit of 300 steps."""
    assert failures(mixed(), tmp_path) == 0


def test_the_mixed_diagram_has_a_fixed_point_form() -> None:
    """State, time in it, place in the line and rate stay whole numbers."""
    fixed = to_fixed_point(mixed(), FixedPointOptions({"In": 4.0}))
    text = generate_c(fixed.program).files["mixed.c"]
    assert "switch (work->Gate_DSTATE)" in text
    assert "work->every_4_steps_count = work->every_4_steps_count + 1;" in text
    execution, exact = Execution(fixed.program), Execution(mixed())
    scale = fixed.format(fixed.program.inputs[0].kind, "In").fraction
    out = fixed.format(fixed.program.outputs[0].kind, "Out")
    for value in np.random.default_rng(5).uniform(-4, 4, 200).round(3):
        raw = round(value * 2**scale)
        found = execution.step({"In": raw})["Out"]
        wanted = float(exact.step({"In": raw / 2**scale})["Out"])
        assert abs(out.real(int(found)) - wanted) < 4 * out.lsb


def test_a_state_space_has_its_states_once_whatever_the_outputs(tmp_path: Path) -> None:
    """Both outputs are those of python-control; one that nothing reads costs nothing."""
    system = control.ss(
        [[0.5, 0.25], [-0.25, 0.75]], [[1.0], [0.5]], [[1.0, 0.0], [0.0, 2.0], [1.0, 1.0]],
        [[0.0], [0.5], [0.0]], 0.01,
    )  # fmt: skip
    diagram = Diagram("filter", 0.01)
    source = diagram.add(Inport("In"))
    block = diagram.add(state_space_block("S", system))
    sinks = [diagram.add(Outport(name)) for name in ("First", "Second")]
    diagram.connect(source, block)
    for output, sink in enumerate(sinks):
        diagram.connect(block, sink, output=output)
    with pytest.raises(DiagramError, match="'S' has 3 output ports, so there is no port 3"):
        diagram.connect(block, source, output=3)
    assert [slot.name for slot in diagram.lower().states] == ["S_DSTATE1", "S_DSTATE2"]
    assert "S_3" not in generate_c(diagram).files["filter.c"]
    found = linearise(diagram)
    assert np.array_equal(found.A, system.A)
    assert np.array_equal(found.C, system.C[:2])
    assert failures(diagram, tmp_path) == 0


def test_an_integrator_integrates_over_time_unless_it_has_a_gain() -> None:
    """The sample time is that of the block, or of the diagram."""
    for own, expected in ((None, 0.02), (0.02, 0.04)):
        diagram = Diagram("d", 0.01)
        chain = Inport("In"), DiscreteIntegrator("I", sample_time=own), Outport("Out")
        diagram.connect_chain(*map(diagram.add, chain))
        execution = Execution(diagram)
        outputs = [float(execution.step({"In": 1.0})["Out"]) for _ in range(4)]
        assert outputs[-1] == pytest.approx(0.03 if own is None else 0.02)
        assert outputs[2] == pytest.approx(expected if own is None else 0.02)
