# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""What a block diagram accepts, and what it says when it cannot have a meaning."""

from __future__ import annotations

import pytest

from ravenbrick import model


def small_loop(method: model.IntegrationMethod) -> model.Diagram:
    """An integrator in its own feedback."""
    diagram = model.Diagram("loop", 0.004)
    source = diagram.add(model.Inport("In"))
    error = diagram.add(model.Sum("Error", signs="+-"))
    integral = diagram.add(model.DiscreteIntegrator("Integral", gain=0.004, method=method))
    sink = diagram.add(model.Outport("Out"))
    diagram.connect_chain(source, error, integral, sink)
    diagram.connect(integral, error, 1)
    return diagram


def test_forward_euler_breaks_a_feedback_loop() -> None:
    """A loop through a block without feed-through has an order of execution."""
    names = [block.name for block in small_loop(model.IntegrationMethod.FORWARD_EULER).order()]
    assert names == ["In", "Integral", "Error", "Out"]


@pytest.mark.parametrize(
    "method", [model.IntegrationMethod.TUSTIN, model.IntegrationMethod.BACKWARD_EULER]
)
def test_an_algebraic_loop_is_named(method: model.IntegrationMethod) -> None:
    """A loop of blocks with feed-through is refused with the names of its blocks."""
    with pytest.raises(
        model.DiagramError, match=r"algebraic loop .*Error -> Integral|Integral -> Error"
    ):
        small_loop(method).lower()


def test_an_open_input_is_named() -> None:
    """An input without a line is reported with its block and port."""
    diagram = model.Diagram("open", 0.004)
    source = diagram.add(model.Inport("In"))
    total = diagram.add(model.Sum("Total"))
    sink = diagram.add(model.Outport("Out"))
    diagram.connect(source, total, 0)
    diagram.connect(total, sink)
    with pytest.raises(model.DiagramError, match="input 1 of block 'Total' is not connected"):
        diagram.lower()


def test_an_unused_output_is_named() -> None:
    """An output that leads nowhere is reported with its block."""
    diagram = model.Diagram("unused", 0.004)
    source = diagram.add(model.Inport("In"))
    diagram.connect(source, diagram.add(model.Outport("Out")))
    diagram.connect(source, diagram.add(model.Gain("Lost")))
    with pytest.raises(model.DiagramError, match="output of block 'Lost' is not connected"):
        diagram.lower()


def test_a_clash_of_number_formats_is_named() -> None:
    """A line between different formats is refused; a conversion between them is accepted."""
    diagram = model.Diagram("types", 0.004)
    source = diagram.add(model.Inport("In", model.DataType.REAL64))
    gain = diagram.add(model.Gain("Twice", gain=2.0))
    with pytest.raises(
        model.DiagramError, match="'In' gives real64_T, but input 0 of 'Twice' takes"
    ):
        diagram.connect(source, gain)
    diagram.connect_chain(source, diagram.add(model.Conversion("Narrow")), gain)


def test_a_sample_time_that_is_no_multiple_is_refused() -> None:
    """Slower rates are whole multiples; ports run with their diagram."""
    with pytest.raises(
        model.DiagramError, match=r"block 'Slow' has the sample time 0\.009 s.*multiple"
    ):
        model.Diagram("model", 0.004).add(model.Gain("Slow", sample_time=0.009))
    with pytest.raises(model.DiagramError, match="port 'In' runs with its diagram"):
        model.Diagram("model", 0.004).add(model.Inport("In", sample_time=0.008))


def test_a_slow_block_runs_in_its_turn_only() -> None:
    """An integrator at a third of the rate, a fast gain around it; the output is held."""
    diagram = model.Diagram("rates", 0.01)
    source, out = diagram.add(model.Inport("In")), diagram.add(model.Outport("Out"))
    slow = diagram.add(model.DiscreteIntegrator("Slow", sample_time=0.03, gain=1.0))
    total = diagram.add(model.Sum("Total"))
    diagram.connect_chain(source, slow, total, out)
    diagram.connect(source, total, 1)
    execution = model.Execution(diagram)
    given = [1.0, 20.0, 300.0, 4.0, 50.0, 600.0, 7.0]
    outputs = [float(execution.step({"In": value})["Out"]) for value in given]
    held = [0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 5.0]
    assert outputs == [h + value for h, value in zip(held, given, strict=True)]


def test_names_are_unique_identifiers_in_any_letter_case() -> None:
    """Ada and file systems do not tell letter cases apart, so the diagram does not either."""
    diagram = model.Diagram("names", 0.004)
    diagram.add(model.Inport("Speed"))
    with pytest.raises(model.DiagramError, match="'speed': the name 'Speed' is taken"):
        diagram.add(model.Inport("speed"))
    with pytest.raises(model.DiagramError, match="identifier"):
        diagram.add(model.Inport("wheel speed"))


def test_a_second_line_into_an_input_is_refused() -> None:
    """The message names the line that is already there."""
    diagram = model.Diagram("lines", 0.004)
    first, second = diagram.add(model.Inport("First")), diagram.add(model.Inport("Second"))
    sink = diagram.add(model.Outport("Out"))
    diagram.connect(first, sink)
    with pytest.raises(model.DiagramError, match="already connected to 'First'"):
        diagram.connect(second, sink)


def test_one_parameter_has_one_value() -> None:
    """Two blocks may share a parameter, but not with different values."""
    diagram = model.Diagram("shared", 0.004)
    source = diagram.add(model.Inport("In"))
    first = diagram.add(model.Gain("First", gain=model.Parameter("Kp", 1.0, "V/V", "gain")))
    second = diagram.add(model.Gain("Second", gain=model.Parameter("Kp", 2.0, "V/V", "gain")))
    diagram.connect_chain(source, first, second, diagram.add(model.Outport("Out")))
    with pytest.raises(
        model.DiagramError, match=r"'Kp' of block 'Second' differs from that of .*'First'"
    ):
        diagram.lower()


def test_a_negative_limit_is_refused() -> None:
    """The block is named."""
    with pytest.raises(ValueError, match="'Limit': the limit must be >= 0"):
        model.Saturation("Limit", limit=-1.0)
