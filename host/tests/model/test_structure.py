# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Subsystems, vectors, buses and units: the program is that of the diagram drawn flat."""

from __future__ import annotations

import pytest

from ravenbrick.codegen import generate_c
from ravenbrick.errors import DesignError
from ravenbrick.model import (
    BusCreator,
    BusSelector,
    Constant,
    Demux,
    Diagram,
    Execution,
    Gain,
    Inport,
    Mux,
    Outport,
    Parameter,
    Product,
    Saturation,
    Subsystem,
    Sum,
    UnitConversion,
    UnitDelay,
)
from ravenbrick.model.structure.units import unit_of


def low_pass(name: str, sample_time: float = 0.01) -> Diagram:
    """y = 0.5 y + 0.5 u, with its memory."""
    d = Diagram(name, sample_time)
    source, total = d.add(Inport("u")), d.add(Sum("Total", signs="++"))
    half, last = d.add(Gain("Half", gain=0.5)), d.add(UnitDelay("Last"))
    d.connect_chain(source, total, half, d.add(Outport("y")))
    d.connect(half, last)
    d.connect(last, total, 1)
    return d


def nested() -> Diagram:
    """Two low passes in a row, the second one two levels deep."""
    deep = Diagram("deep", 0.01)
    inner = deep.add(Subsystem("Pass", diagram=low_pass("p")))
    deep.connect_chain(deep.add(Inport("u")), inner, deep.add(Outport("y")))
    d = Diagram("nested", 0.01)
    one, two = (
        d.add(Subsystem("Pass", diagram=low_pass("p"))),
        d.add(Subsystem("Deep", diagram=deep)),
    )
    d.connect_chain(d.add(Inport("u")), one, two, d.add(Outport("y")))
    return d


def outputs(diagram: Diagram, steps: int, **inputs: float) -> list[dict[str, float]]:
    """Successive steps with the same inputs."""
    run = Execution(diagram)
    return [{name: float(v) for name, v in run.step(inputs).items()} for _ in range(steps)]


def test_subsystems_compute_what_their_blocks_do() -> None:
    """By hand: 1/4, 1/2, 11/16 ...; the blocks keep their paths and get names for the C."""
    diagram = nested()
    assert [row["y"] for row in outputs(diagram, 3, u=1.0)] == [0.25, 0.5, 0.6875]
    flat = diagram.flat()
    assert flat.paths["Deep_Pass_Last"] == "Deep/Pass/Last"
    text = generate_c(diagram).files["nested.c"]
    assert "'<Root>/Pass_Half'" in text
    assert "'<Root>/Deep_Pass_Half'" in text


def test_a_slower_subsystem_runs_at_its_own_rate() -> None:
    """Its memory changes in every second step, and so does what follows from it."""
    d = Diagram("fast", 0.01)
    slow = d.add(Subsystem("Slow", diagram=low_pass("slow", 0.02)))
    d.connect_chain(d.add(Inport("u")), slow, d.add(Outport("y")))
    assert [row["y"] for row in outputs(d, 4, u=1.0)] == [0.5, 0.5, 0.75, 0.75]


def test_an_enabled_subsystem_keeps_its_memory_while_it_stands() -> None:
    """Enabled in no step, the low pass gives half of its input for ever."""
    d = Diagram("enabled", 0.01)
    part, on = d.add(Subsystem("Part", diagram=low_pass("part"))), d.add(Inport("on"))
    d.connect_chain(d.add(Inport("u")), part, d.add(Outport("y")))
    d.enable(part, on)
    assert [row["y"] for row in outputs(d, 3, u=1.0, on=0.0)] == [0.5, 0.5, 0.5]
    assert [row["y"] for row in outputs(d, 3, u=1.0, on=1.0)] == [0.5, 0.75, 0.875]


def test_parts_enabled_with_reset_begin_anew_after_each_pause() -> None:
    """Two low passes that one signal enables: both start from zero again, and only then."""
    d = Diagram("enabled", 0.01)
    u, on = d.add(Inport("u")), d.add(Inport("on"))
    for name in ("one", "two"):
        part = d.add(Subsystem(name.title(), diagram=low_pass(name)))
        d.connect_chain(u, part, d.add(Outport(f"y_{name}")))
        d.enable(part, on, reset=True)
    run = Execution(d)
    steps = [run.step({"u": 1.0, "on": enabled}) for enabled in (1.0, 1.0, 0.0, 1.0, 1.0)]
    wanted = [0.5, 0.75, 0.875, 0.5, 0.75]
    assert [[float(y) for y in step.values()] for step in steps] == [[y, y] for y in wanted]


def test_blocks_compute_on_vectors_element_by_element() -> None:
    """A gain, a limit with memory and a sum with a single number."""
    d = Diagram("vector", 0.01)
    mux, demux = d.add(Mux("Both")), d.add(Demux("Parts"))
    gain, last, total = d.add(Gain("Twice", gain=2.0)), d.add(UnitDelay("Last")), d.add(
        Sum("Total", signs="++"))  # fmt: skip
    for place, name in enumerate("ab"):
        d.connect(d.add(Inport(name)), mux, place)
        d.connect(demux, d.add(Outport(f"out_{name}")), output=place)
    d.connect_chain(mux, gain, last, total, demux)
    d.connect(d.add(Constant("One", value=1.0)), total, 1)
    assert outputs(d, 2, a=1.0, b=5.0) == [
        {"out_a": 1.0, "out_b": 1.0}, {"out_a": 3.0, "out_b": 11.0},
    ]  # fmt: skip


def bus(field: str) -> Diagram:
    """A bus in a bus through a gain, and one field of it."""
    d = Diagram("buses", 0.01)
    body = d.add(BusCreator("Body", fields=("pitch", "rate")))
    robot = d.add(BusCreator("Robot", fields=("body", "wheel")))
    gain, chosen = d.add(Gain("G", gain=10.0)), d.add(BusSelector("Chosen", fields=(field,)))
    for place, name in enumerate(("pitch", "rate")):
        d.connect(d.add(Inport(name)), body, place)
    d.connect(body, robot, 0)
    d.connect(d.add(Inport("wheel")), robot, 1)
    d.connect_chain(robot, gain, chosen, d.add(Outport("y")))
    return d


def test_fields_of_buses_are_chosen_by_name() -> None:
    """Through blocks, and in buses inside buses; for an unknown one those there are are named."""
    found = outputs(bus("body.rate"), 1, pitch=1.0, rate=2.0, wheel=3.0)
    assert found == [{"y": 20.0}]
    with pytest.raises(DesignError, match=r"no field 'body\.yaw'; there are: pitch, rate"):
        bus("body.yaw").lower()


def test_signals_of_different_widths_are_refused() -> None:
    """The block and both numbers are named."""
    d = Diagram("widths", 0.01)
    total = d.add(Sum("Total", signs="++"))
    for place, count in enumerate((2, 3)):
        mux = d.add(Mux(f"M{count}", count=count))
        one = d.add(Constant(f"C{count}", value=1.0))
        for port in range(count):
            d.connect(one, mux, port)
        d.connect(mux, total, place)
    d.connect_chain(total, d.add(Demux("D")), d.add(Outport("y")))
    with pytest.raises(DesignError, match="'Total' of diagram 'widths' has inputs with 2 and 3"):
        d.lower()


def joined(one: str, two: str) -> Diagram:
    """The sum of two inputs in these units."""
    d = Diagram("units", 0.01)
    total = d.add(Sum("Total", signs="+-"))
    d.connect(d.add(Inport("Distance", unit=one)), total, 0)
    d.connect(d.add(Inport("Gyro", unit=two)), total, 1)
    d.connect_chain(total, d.add(UnitDelay("Last")), d.add(Outport("y")))
    return d


def test_metres_plus_radians_per_second_is_an_error_that_names_both_ends() -> None:
    """Different quantities; with the same quantity in another unit the remedy is a conversion."""
    with pytest.raises(DesignError) as caught:
        joined("m", "rad/s").lower()
    assert str(caught.value) == (
        "diagram 'units': at 'Total' a signal in m (from 'Distance') meets one in rad/s (from "
        "'Gyro'); these are different quantities"
    )
    with pytest.raises(DesignError, match="put a UnitConversion between them"):
        joined("deg/s", "rad/s").lower()
    joined("N m", "kg m^2/s^2").lower()
    units = joined("", "m")
    units.lower()
    assert units.units["Distance:0"] == units.units["Last:0"] == "m"


def test_units_follow_gains_products_and_conversions() -> None:
    """Volts from a duty cycle by a factor, times amperes in watts."""
    d = Diagram("power", 0.01)
    volts = d.add(UnitConversion("Volts", source="duty", target="V", factor=9.0))
    amps = d.add(Gain("Amps", gain=Parameter("g", 0.5, "A/V", "conductance")))
    power = d.add(Product("Power"))
    d.connect_chain(
        d.add(Inport("duty", unit="duty")), volts, amps, d.add(Saturation("L", limit=5.0))
    )
    d.connect(volts, power, 0)
    d.connect(d.blocks[-1], power, 1)
    d.connect(power, d.add(Outport("p", unit="mW")))
    with pytest.raises(DesignError, match="meets one in V"):
        d.lower()
    with pytest.raises(DesignError, match="another kind of quantity than V; give the factor"):
        UnitConversion("Volts", source="duty", target="V")
    assert UnitConversion("C", source="deg/s", target="rad/s").gain == pytest.approx(0.0174533)
    assert UnitConversion("C", source="rpm", target="deg/s").gain == pytest.approx(6.0)


def test_units_of_a_subsystem_s_ports_are_checked_with_the_lines_outside() -> None:
    """The port is named by its path."""
    inner = Diagram("inner", 0.01)
    inner.connect_chain(inner.add(Inport("speed", unit="rad/s")), inner.add(Outport("y")))
    d = Diagram("outer", 0.01)
    part = d.add(Subsystem("Part", diagram=inner))
    d.connect_chain(d.add(Inport("way", unit="m")), part, d.add(Outport("y")))
    with pytest.raises(
        DesignError, match=r"m \(from 'way'\) meets one in rad/s \(from 'Part/speed'"
    ):
        d.lower()
    with pytest.raises(DesignError, match="no inport 'way'; there are: speed"):
        part.input_port("way")


@pytest.mark.parametrize("text", ["m/", "(m", "m)", "3 +", "^2"])
def test_what_is_no_unit_is_refused(text: str) -> None:
    """With the text."""
    with pytest.raises(DesignError, match="is not a unit"):
        unit_of(text)
