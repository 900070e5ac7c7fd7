# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Every block against its definition, and what each refuses."""

from __future__ import annotations

from collections.abc import Callable

import control
import numpy as np
import pytest
from verification.support.codegen.block_table import TABLE, block_diagram

import ravenbrick.model as model
from ravenbrick.model import (
    Backlash,
    Block,
    ComplementaryFilter,
    DataType,
    DeadZone,
    Delay,
    Diagram,
    DiagramError,
    DiscreteStateSpace,
    Execution,
    Gain,
    Inport,
    LookupTable,
    MovingAverage,
    Outport,
    PidController,
    Pulse,
    Quantiser,
    RateLimit,
    Relay,
    Sine,
    Step,
    UnitDelay,
    linearise,
    state_space_block,
    transfer_function_block,
)
from ravenbrick.model.blocks.continuous import ContinuousBlock
from ravenbrick.model.flattening import with_shifts
from ravenbrick.model.structure.signals import RoutingBlock

STEPS = 400


def inputs_for(diagram: Diagram, seed: int) -> np.ndarray:
    """Values with ties, jumps and plateaus, exact in both formats; shape (steps, ports)."""
    ports = sum(isinstance(block, Inport) for block in diagram.blocks)
    random = np.random.default_rng(seed)
    values = random.integers(-40, 41, (STEPS, ports)) / 4.0
    return np.where(random.random((STEPS, ports)) < 0.3, np.roll(values, 1, axis=0), values)


def outputs_of(diagram: Diagram, inputs: np.ndarray) -> np.ndarray:
    """The simulation."""
    execution = Execution(diagram)
    rows = ({f"In{port}": value for port, value in enumerate(row)} for row in inputs)
    return np.array([float(execution.step(row)["Out"]) for row in rows])


@pytest.mark.parametrize(
    ("data_type", "tolerance"), [(DataType.REAL64, 1e-11), (DataType.REAL32, 2e-4)]
)
@pytest.mark.parametrize("name", TABLE)
def test_each_block_computes_its_definition(
    name: str, data_type: DataType, tolerance: float
) -> None:
    """Random steps against a definition written without the library."""
    diagram = block_diagram(name, data_type)
    inputs = inputs_for(diagram, seed=3)
    expected = TABLE[name][1](inputs)
    assert np.allclose(outputs_of(diagram, inputs), expected, rtol=tolerance, atol=tolerance)


def test_the_table_has_every_block() -> None:
    """A new block cannot go without a definition here; ports and conversions are in diagrams."""
    library = {
        kind
        for name in model.__all__
        if isinstance(kind := getattr(model, name), type) and issubclass(kind, Block)
    }
    tested = {type(block) for block, _ in TABLE.values()}
    others = (ContinuousBlock, RoutingBlock, model.Subsystem)  # test_simulation, test_structure
    library = {kind for kind in library if not issubclass(kind, others)}
    assert library - tested == {Block, model.Inport, model.Outport, model.Conversion}


def test_a_complementary_filter_trusts_its_rate_unless_told_otherwise() -> None:
    """By hand, at 100 Hz: 0.98 of 0.01 s at 50 rad/s and 0.02 of 3 rad."""
    diagram = Diagram("tilt", 0.01)
    rate, angle = diagram.add(Inport("In0")), diagram.add(Inport("In1"))
    tilt, out = diagram.add(ComplementaryFilter("Tilt")), diagram.add(Outport("Out"))
    diagram.connect(rate, tilt)
    diagram.connect(angle, tilt, 1)
    diagram.connect(tilt, out)
    assert outputs_of(diagram, np.array([[50.0, 3.0]])) == pytest.approx([0.55])


LINEAR = ["delay", "moving_average", "transfer_function", "state_space", "pid", "complementary"]


@pytest.mark.parametrize("name", LINEAR)
def test_linear_blocks_linearise_to_what_they_compute(name: str) -> None:
    """python-control's response of the linearised diagram, from the initial states."""
    diagram = block_diagram(name, DataType.REAL64)
    inputs = inputs_for(diagram, seed=5)
    start = [slot.initial for slot in with_shifts(diagram.lower()).states]
    found = control.forced_response(linearise(diagram), U=inputs.T, X0=start).outputs
    assert np.allclose(np.ravel(found), outputs_of(diagram, inputs), atol=1e-9)


def test_a_nonlinear_block_cannot_be_linearised_and_is_named() -> None:
    """The message begins with the block."""
    with pytest.raises(DiagramError, match="block 'B': a select is not linear"):
        linearise(block_diagram("relay"))


def test_the_sine_is_exact_to_its_stated_error() -> None:
    """3e-7 of the amplitude in single, 1e-15 in double precision, over 20 periods."""
    for data_type, bound in ((DataType.REAL32, 3e-7), (DataType.REAL64, 1e-15)):
        diagram = block_diagram("sine", data_type)
        inputs = np.zeros((740, 1))
        wanted = 3.0 * np.sin(2 * np.pi * (np.arange(740) % 37) / 37)
        assert np.abs(outputs_of(diagram, inputs) - wanted).max() <= 3 * bound


def test_a_quantiser_passes_what_has_no_fraction() -> None:
    """Values beyond 2^23 are whole numbers already; so is infinity."""
    diagram = Diagram("q", 0.01)
    source = diagram.add(Inport("In0"))
    diagram.connect_chain(source, diagram.add(Quantiser("B")), diagram.add(Outport("Out")))
    given = [8388608.0, -16777216.0, 1e30, np.inf, 8388606.5, 0.49999997]
    values = np.array(given)[:, np.newaxis]
    wanted = [8388608.0, -16777216.0, float(np.float32(1e30)), np.inf, 8388607.0, 0.0]
    assert outputs_of(diagram, values).tolist() == wanted


def test_systems_of_python_control_become_blocks() -> None:
    """Same impulse response from a transfer function and its state space."""
    system = control.tf([0.4, 0.1], [2.0, -1.2, 0.5], 0.01)
    responses = []
    for block in (
        transfer_function_block("B", system, DataType.REAL64),
        state_space_block("B", control.ss(system), data_type=DataType.REAL64),
    ):
        diagram = Diagram("one", 0.01)
        source = diagram.add(Inport("In0", DataType.REAL64))
        out = diagram.add(Outport("Out", DataType.REAL64))
        diagram.connect_chain(source, diagram.add(block), out)
        responses.append(outputs_of(diagram, np.eye(30)[:, :1]))
    expected = control.forced_response(system, U=np.eye(30)[0]).outputs
    for response in responses:
        assert np.allclose(response, expected, atol=1e-12)


def test_a_pid_of_gains_has_tunable_parameters() -> None:
    """Kp, Ki Ts and Kd N under the block's name."""
    block = PidController.of_gains("Wheel", (2.0, 5.0, 0.1), 50.0, 0.01)
    assert [(p.name, p.value) for p in block.values()] == [
        ("Wheel_Kp", 2.0),
        ("Wheel_Ki_Ts", 0.05),
        ("Wheel_Kd_N", 5.0),
    ]
    assert block.filter_step == 0.5


REFUSED = [
    (lambda: DeadZone("X", start=2.0, end=1.0), "must begin at or below its end"),
    (lambda: RateLimit("X", falling=-1.0), "falling must be >= 0"),
    (lambda: Quantiser("X", interval=0.0), "interval must be > 0"),
    (lambda: Relay("X", on_above=1.0, off_below=2.0), "must not be above"),
    (lambda: Backlash("X", width=-1.0), "width must be >= 0"),
    (lambda: LookupTable("X", breakpoints=(0.0, 0.0)), "breakpoints must rise"),
    (lambda: LookupTable("X", breakpoints=(0.0, 1.0), table=(1.0,)), "as many values"),
    (lambda: Delay("X", length=0), "between 1 and 1024 samples, not 0"),
    (lambda: MovingAverage("X", length=1), "between 2 and 256"),
    (lambda: ComplementaryFilter("X", weight=1.5), "between 0 and 1"),
    (lambda: PidController("X", filter_step=2.5), "between 0 and 2, not 2.5"),
    (lambda: DiscreteStateSpace("X", a=((1.0, 2.0),)), "shapes of a, b, c, d"),
    (lambda: Step("X", at_sample=-1), "at_sample must lie between 0"),
    (lambda: Pulse("X", period=4, width=4), "between 1 and 3 samples"),
    (lambda: Sine("X", period=1), "period must lie between 2"),
    (lambda: state_space_block("X", control.ss(-1, 1, 1, 0)), "is continuous"),
    (lambda: transfer_function_block("X", control.tf([1], [1, 1])), "is continuous"),
]


@pytest.mark.parametrize(("make", "message"), REFUSED, ids=[text for _, text in REFUSED])
def test_wrong_values_are_refused_by_block(make: Callable[[], object], message: str) -> None:
    """The block's name stands in front, the expected range is in the sentence."""
    with pytest.raises(ValueError, match=message) as caught:
        make()
    assert str(caught.value).startswith("block 'X': ")


@pytest.mark.parametrize("name", [name for name in TABLE if TABLE[name][0].input_types])
def test_an_open_port_is_named_for_every_block(name: str) -> None:
    """Block and port number, for the last port of each block."""
    block = TABLE[name][0]
    last = len(block.input_types) - 1
    diagram = Diagram("open", 0.01)
    diagram.add(block)
    for port in range(last):
        diagram.connect(diagram.add(Inport(f"In{port}")), block, port)
    diagram.connect(block, diagram.add(Outport("Out")))
    with pytest.raises(DiagramError, match=f"input {last} of block 'B' is not connected"):
        diagram.lower()


def test_values_with_the_same_name_are_found() -> None:
    """A block cannot be called like another's state."""
    diagram = Diagram("clash", 0.01)
    source = diagram.add(Inport("In"))
    first = diagram.add(RateLimit("Speed"))
    second = diagram.add(Gain("Speed_change"))
    memory = diagram.add(UnitDelay("Last"))
    diagram.connect_chain(source, first, second, memory, diagram.add(Outport("Out")))
    with pytest.raises(DiagramError, match="'Speed' and 'Speed_change' both have a value"):
        diagram.lower()
