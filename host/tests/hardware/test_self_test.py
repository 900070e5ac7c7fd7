# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The self-test finds which timing parameters of a brick differ, and about what they are."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from ravenbrick.errors import ImageFileError, RecordError
from ravenbrick.image.build import build_image
from ravenbrick.image.elf import ElfImage
from ravenbrick.project.robot import read_robot
from ravenbrick.project.workspace import Workspace, tree
from ravenbrick.self_test.comparison import Comparison, compare, equipment, verdict
from ravenbrick.self_test.parameters import PARAMETERS, UNSEEN, Parameter
from ravenbrick.self_test.record import (
    PARTS,
    Record,
    Row,
    read_record,
    recorded_image,
    write_record,
)
from ravenbrick.self_test.taking import from_virtual_brick

pytestmark = pytest.mark.usefixtures("self_test_runs")
LONG = pytest.mark.long("a search with all parameters")
SEVERAL = {
    "flash_sequential_arm_wait_cycles": 0,
    "thumb_odd_target_cycles": 1,
    "flash_data_wait_cycles": 2,
    "pdc_steal_cycles": 4,
    "aic_edge_cycles": 5,
    "pio_filter_cycles": 2,
    "core_sync_cycles": 2,
    "mask_change_delayed": False,
    "coprocessor_stretch_cycles": 480,
}


@pytest.fixture(scope="module")
def image() -> ElfImage:
    """The self-test, built."""
    project = tree() / "examples" / "self-test"
    return build_image(Workspace.of(project), read_robot(project), "ram").image


@pytest.fixture(scope="module")
def nominal(image: ElfImage) -> Record:
    """The whole record of the virtual brick as it is."""
    return from_virtual_brick(image, equipment())


def altered(image: ElfImage, until: str, **timing: Any) -> Record:
    """The record of a virtual brick with other timing."""
    return from_virtual_brick(image, {**equipment(), "timing": timing}, until)


def verdicts(comparison: Comparison) -> dict[str, str]:
    """By parameter."""
    return {e.parameter.name: verdict(e) for e in comparison.estimates}


def test_nothing_altered_confirms_every_parameter(image: ElfImage, nominal: Record) -> None:
    """All rows agree, and no neighbour of a value gives the same rows, but for a delay that ends
    before the next load can see it."""
    comparison = compare(nominal, image)
    hidden = {"aic_level_cycles": "possible"}
    assert verdicts(comparison) == {p.name: "confirmed" for p in PARAMETERS} | hidden
    assert comparison.timing == {} and comparison.unexplained == []
    assert all(row.agrees for row in comparison.rows)
    assert set(comparison.missing) == {"motor.B", "motor.C"}


@LONG
def test_altered_parameters_are_found_together(image: ElfImage) -> None:
    """Nine at once, each with its value; the stretch within a microsecond."""
    comparison = compare(altered(image, PARTS[1], **SEVERAL), image)
    found = comparison.timing
    stretch = int(found.pop("coprocessor_stretch_cycles"))
    assert stretch == pytest.approx(SEVERAL["coprocessor_stretch_cycles"], abs=48)
    assert found == {k: v for k, v in SEVERAL.items() if k != "coprocessor_stretch_cycles"}
    assert comparison.unexplained == []
    unmoved = {name for name, word in verdicts(comparison).items() if word != "moved"}
    assert unmoved == {p.name for p in PARAMETERS} - set(SEVERAL)


@LONG
def test_what_a_slower_bus_hides_is_possible_not_confirmed(image: ElfImage) -> None:
    """With three cycles for a register no load comes early enough to see a short delay."""
    comparison = compare(altered(image, PARTS[1], apb_cycles=3), image)
    assert comparison.timing == {"apb_cycles": 3}
    hidden = next(e for e in comparison.estimates if e.parameter.name == "aic_level_cycles")
    assert verdict(hidden) == "possible" and hidden.values == (0, 1, 2, 3, 4)


@pytest.mark.parametrize("parameter", PARAMETERS, ids=lambda p: p.name)
def test_each_parameter_moves_its_rows(
    image: ElfImage, nominal: Record, parameter: Parameter
) -> None:
    """Otherwise the record could not say anything about it."""
    others = [value for value in parameter.values if value != parameter.nominal] or [480]
    record = altered(image, PARTS[0], **{parameter.name: others[-1]})
    assert all(record.rows[name] != nominal.rows[name] for name in parameter.rows)


@pytest.mark.parametrize("name", UNSEEN)
def test_no_row_depends_on_an_unseen_parameter(image: ElfImage, nominal: Record, name: str) -> None:
    """It is named as such in each comparison."""
    other = {"twi_stop_decision": "release", "coprocessor_pass_cycles": 2_000}.get(name, 0)
    rows = altered(image, PARTS[0], **{name: other}).rows
    assert {key: nominal.rows[key] for key in rows} == rows


def test_a_row_that_no_parameter_explains_is_named(image: ElfImage, nominal: Record) -> None:
    """A multiplication that takes another cycle is not in the table of parameters."""
    slower = {**nominal.rows, "ram.multiplications": Row(360.0, "cycles")}
    comparison = compare(replace(nominal, rows=slower), image)
    assert comparison.unexplained == ["ram.multiplications"]
    assert comparison.timing == {}


def test_the_record_is_kept_with_its_image(
    image: ElfImage, nominal: Record, tmp_path: Path
) -> None:
    """It is read back as it was, and another image beside it is refused."""
    file = tmp_path / "brick.jsonl"
    write_record(file, nominal, image)
    again = read_record(file)
    assert again == nominal
    assert recorded_image(file, again).content == image.content
    with pytest.raises(ImageFileError, match=r"brick\.elf: is not the image"):
        recorded_image(file, replace(again, image="0"))


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        (None, "cannot be read"),
        ("{}\n", "its first line has no 'record'"),
        ('{"record": 2, "source": "usb", "image": ""}\n', "of version 2, not 1"),
        ('{"record": 1, "source": "usb", "image": ""}\nwhat\n', "line 1 is not of a self-test"),
        ('{"record": 1, "source": "usb", "image": ""}\n', "before the part 'timing' is finished"),
    ],
)
def test_a_wrong_record_is_a_sentence(tmp_path: Path, text: str | None, sentence: str) -> None:
    """It names the file and what is wrong with it."""
    file = tmp_path / "brick.jsonl"
    if text is not None:
        file.write_text(text)
    with pytest.raises(RecordError, match=r"brick\.jsonl: .*" + sentence.replace(".", r"\.")):
        read_record(file)
