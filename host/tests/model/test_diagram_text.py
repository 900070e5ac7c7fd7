# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Diagrams as text: read again they are the same program; errors name file, block and remedy."""

from __future__ import annotations

import pytest
from verification.support.codegen.block_table import TABLE, block_diagram

from ravenbrick.errors import DesignError
from ravenbrick.model import (
    NXT_MOTOR,
    CustomDerivatives,
    DataType,
    Diagram,
    Inport,
    Outport,
    diagram_text,
    read_diagram,
    vehicle_plant,
)


@pytest.mark.parametrize("name", TABLE)
def test_each_block_is_read_as_it_was_written(name: str) -> None:
    """The same program, and the same text again; functions in Python are refused by name."""
    diagram = block_diagram(name, DataType.REAL32)
    try:
        text = diagram_text(diagram)
    except DesignError as error:
        assert "its function is a Python object" in str(error)
        return
    assert read_diagram(text).lower() == diagram.lower()
    assert diagram_text(read_diagram(text)) == text


def test_subsystems_are_tables_inside_tables() -> None:
    """The vehicle with its two motors, continuous blocks and units."""
    plant = vehicle_plant("vehicle", NXT_MOTOR, wheel_radius=0.028, track=0.11, mass=0.6)
    text = diagram_text(plant)
    assert "[blocks.Left.blocks.Armature]" in text
    found = read_diagram(text)
    assert found.lower(continuous=True) == plant.lower(continuous=True)


GOOD = """
name = "d"
sample_time = 0.01
[blocks.u]
kind = "Inport"
[blocks.y]
kind = "Outport"
inputs = ["u"]
"""


@pytest.mark.parametrize(
    ("old", "new", "sentence"),
    [
        ('"Outport"', '"Exit"', "block 'y': there is no kind of block 'Exit'"),
        ('["u"]', '["v"]', "block 'y': there is no block 'v' to feed it"),
        ('"Inport"', '"Inport"\ngain = 2.0', "block 'u' of kind Inport has no 'gain'; there are"),
        ("sample_time = 0.01", "", "'sample_time' is missing"),
        ('name = "d"', "name = d", "Invalid value"),
    ],
)
def test_mistakes_in_the_text_are_named(old: str, new: str, sentence: str) -> None:
    """After the file."""
    assert read_diagram(GOOD).name == "d"
    with pytest.raises(DesignError, match=f"^robot.toml: .*{sentence}"):
        read_diagram(GOOD.replace(old, new), "robot.toml")


def test_a_function_has_no_text() -> None:
    """The block and the field are named."""
    diagram = Diagram("d", 0.01)
    own = diagram.add(CustomDerivatives("Own", derivatives=lambda x, u: x))
    wide = DataType.REAL64
    diagram.connect_chain(diagram.add(Inport("u", wide)), own, diagram.add(Outport("y", wide)))
    with pytest.raises(DesignError, match="block 'Own': its derivatives is a Python object"):
        diagram_text(diagram)
