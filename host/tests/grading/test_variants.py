# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Robots and numbers of each student's own: drawn again by whoever has the key, by nobody else."""

from __future__ import annotations

import hashlib
import hmac
import json
import re
from dataclasses import replace
from pathlib import Path

import pytest
from verification.support.paths import ROOT

from ravenbrick.errors import ProjectFileError, UsageError
from ravenbrick.grading.adapters import readable
from ravenbrick.grading.campaign import run_campaign
from ravenbrick.grading.isolation import TRUST
from ravenbrick.grading.rubric import Rubric, read_rubric
from ravenbrick.grading.student_folder import read_class, recorded_scenarios, write_folder
from ravenbrick.grading.submission import Submission
from ravenbrick.grading.variants import drawn_motor, filled, new_key, read_key
from ravenbrick.project.robot import Quantity, read_robot

RUBRICS = ROOT / "docs" / "lessons" / "rubrics"
KEY = bytes(range(32))


def rubric(sheet: str) -> Rubric:
    """A shipped rubric."""
    return read_rubric(RUBRICS / f"{sheet}.toml")


def test_a_variant_depends_on_key_student_and_sheet_alone() -> None:
    """Spellings of one id are one student."""
    motor = rubric("lab-03")
    facts = motor.variant(KEY, "s01").facts
    assert facts == motor.variant(KEY, " S01").facts
    others = (
        motor.variant(bytes(32), "s01"),
        motor.variant(KEY, "s02"),
        replace(motor, name="lab-99").variant(KEY, "s01"),
    )
    assert all(other.facts["motor_b_gain"] != facts["motor_b_gain"] for other in others)


def test_the_seed_is_hmac_sha_256_by_the_standard_library_as_the_guide_says() -> None:
    """The guide's line of Python draws the same number."""
    import random

    message = json.dumps(["ravenbrick class", 1, "lab-06", "s01"])
    seed = hmac.new(KEY, message.encode(), hashlib.sha256).hexdigest()
    expected = 20 + random.Random(f"{seed} low_ms").randint(0, 25)
    assert rubric("lab-06").variant(KEY, "s01").numbers["low_ms"] == expected


def test_own_constants_are_within_the_tolerances_of_the_catalogue() -> None:
    """And the student's robot.toml still allows all that the project's allows."""
    sheet = rubric("lab-04")
    nominal = sheet.robot.motors["nxt"]
    for number in range(8):
        for name, own in sheet.variant(KEY, f"s{number}").robot.motors["own_b"].items():
            assert nominal[name].allows(own.value), name
            assert own.value >= 0 and own.allows(nominal[name].value - nominal[name].tolerance)


def test_constants_with_a_tolerance_are_drawn_and_others_are_not() -> None:
    """A tolerance of 1 is one as well."""
    robot = rubric("lab-04").robot
    motor = {"resistance": Quantity(8.0, "ohm", 1.0, ""), "inductance": Quantity(0.005, "H", 0, "")}
    made = replace(robot, motors=dict.fromkeys(robot.motors, motor))
    drawn = drawn_motor(made, "B", "seed")
    assert drawn.keys() == {"resistance"} and drawn["resistance"] != 8.0


def test_the_folder_of_a_sheet_with_known_constants_has_the_robot_that_is_graded(
    tmp_path: Path,
) -> None:
    """robot.toml says what the grader computes with, to the last digit."""
    sheet = rubric("lab-04")
    variant = write_folder(tmp_path / "s1" / "lab-04", sheet, KEY, "s1")
    robot = read_robot(tmp_path / "s1" / "lab-04")
    assert robot.motors["own_b"] == variant.robot.motors["own_b"]
    assert robot.battery == variant.robot.battery and robot.name == "lab-04"
    assert "settling_time_ms" in (tmp_path / "s1" / "lab-04" / "own.toml").read_text()


def test_a_gyro_of_ones_own_is_in_the_folder_and_asked_for(tmp_path: Path) -> None:
    """Within its tolerance, one for each student; its count is what the nearest whole one is."""
    sheet = rubric("lab-10")
    nominal = sheet.robot.sensor_ports["4"].rest
    variants = [sheet.variant(KEY, f"s{number}") for number in range(40)]
    rests = [variant.robot.sensor_ports["4"].rest for variant in variants]
    assert nominal is not None and all(own and nominal.allows(own.value) for own in rests)
    assert len({own.value for own in rests if own}) > 30
    assert all(abs(v.facts["sensor_4_rest"] - v.facts["sensor_4_count"]) <= 0.5 for v in variants)
    write_folder(tmp_path / "lab-10", sheet, KEY, "s0")
    assert read_robot(tmp_path / "lab-10").sensor_ports["4"].rest == rests[0]
    asked = {check.name: check.value for check in sheet.of(variants[0]).checks}
    count = variants[0].facts["sensor_4_count"]
    assert f"between {count - 0.1:.7g} and" in asked["count of the gyro that the program finds"]


def test_a_hidden_robot_is_nowhere_in_the_students_folder(tmp_path: Path) -> None:
    """Neither constants nor signals that give them away; robot.toml is the template's."""
    hidden = rubric("lab-03")
    assert hidden.individual is not None
    without = replace(hidden, individual=replace(hidden.individual, records=()))
    variant = write_folder(tmp_path / "lab-03", without, KEY, "s1")
    text = "".join(f.read_text() for f in tmp_path.rglob("*.toml"))
    assert "own_b" not in text
    for quantity in variant.robot.motors["own_b"].values():
        assert quantity.value == 0 or repr(quantity.value) not in text


def test_a_recording_is_of_a_scenario_in_a_project() -> None:
    """Of the rubric's or another one, which is built for it; outside of projects there is none."""
    hidden = rubric("lab-03")
    assert hidden.individual is not None
    projects = recorded_scenarios(hidden)
    assert projects and all((project / "robot.gpr").is_file() for project in projects.values())
    assert all(path.is_relative_to(project) for path, project in projects.items())
    alone = replace(hidden, individual=replace(hidden.individual, records=("step.toml",)))
    with pytest.raises(UsageError, match=r"step\.toml: is in no project"):
        recorded_scenarios(alone)


def test_answers_are_graded_by_the_numbers_of_their_student(tmp_path: Path) -> None:
    """The same hand-in under two names: all points for its author, none for the neighbour."""
    sheet = rubric("lab-03")
    facts = sheet.variant(KEY, "s1").facts
    answers = (
        f"gain_rad_s_v = {facts['motor_b_gain']}\n"
        f"time_constant_ms = {1000 * facts['motor_b_time_constant']}\n"
        f"friction_v = {facts['motor_b_friction']}\n"
    )
    found = []
    for name in ("s1", "s2"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "answers.toml").write_text(answers)
        found.append(Submission(name, tmp_path / name))
    first, second = run_campaign(sheet, found, tmp_path / "out", 2, border=TRUST, class_key=KEY)
    assert first["points"] == first["of"] and second["points"] == 0
    with pytest.raises(UsageError, match="no table \\[individual\\]"):
        run_campaign(rubric("lab-01"), found, tmp_path / "out", 1, border=TRUST, class_key=KEY)


LIMITED = f"""schema_version = 1
name = "limited"
description = "one own number among common points"
project = "{ROOT / "examples" / "blank"}"
folders = ["src"]

[individual]
share_without_own_answers = 0.4

[individual.numbers]
own_ms = {{ least = 1, most = 1000, step = 1 }}

[[checks]]
name = "common"
points = 9
answer = "common at least 1"

[[checks]]
name = "own"
points = 1
answer = "own between 1 and 2"
own = "own between {{own_ms}} and {{own_ms}}"
"""


def test_a_copied_hand_in_keeps_a_share_of_all_points_only(tmp_path: Path) -> None:
    """It has nine of ten points for common work; the report says what took five of them."""
    (tmp_path / "limited.toml").write_text(LIMITED)
    sheet = read_rubric(tmp_path / "limited.toml")
    number = sheet.variant(KEY, "s1").numbers["own_ms"]
    found = []
    for name, text in (("s1", f"common = 1\nown = {number}\n"), ("s2", "common = 0\nown = 0\n")):
        (tmp_path / name).mkdir()
        (tmp_path / name / "answers.toml").write_text(text)
        found.append(Submission(name, tmp_path / name))
    (tmp_path / "s3").mkdir()
    (tmp_path / "s3" / "answers.toml").write_text(f"common = 1\nown = {number}\n")
    found.append(Submission("s3", tmp_path / "s3"))
    out = tmp_path / "out"
    author, wrong, copy = run_campaign(sheet, found, out, 2, border=TRUST, class_key=KEY)
    assert [author["points"], wrong["points"], copy["points"]] == [10, 0, 4]
    assert copy["checks"][-1]["points"] == -5
    assert "'own' does not hold for the author's own numbers: at most 4 points" in readable([copy])
    assert len(author["checks"]) == len(wrong["checks"]) == 2


def test_a_key_is_drawn_once_and_is_its_owners_alone(tmp_path: Path) -> None:
    """Another one would change every robot."""
    new_key(tmp_path / "class.key")
    assert (tmp_path / "class.key").stat().st_mode & 0o077 == 0
    assert len(read_key(tmp_path / "class.key")) == 32
    with pytest.raises(UsageError, match="exists; a new key would change"):
        new_key(tmp_path / "class.key")
    with pytest.raises(UsageError, match="--new-key"):
        read_key(tmp_path / "none")
    (tmp_path / "short").write_text("abc")
    with pytest.raises(UsageError, match="64 hexadecimal digits"):
        read_key(tmp_path / "short")


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("id,name\ns1,A\nS1,B\n", r"class.csv:3: 'S1' is also in line 2"),
        ("id\n../x\n", r"class.csv:2: '../x': expected an id"),
        ("id\n=cmd\n", r"class.csv:2: '=cmd': expected an id"),
        ("id\n", "no student"),
    ],
)
def test_a_bad_list_of_a_class_is_refused_with_its_line(
    content: str, message: str, tmp_path: Path
) -> None:
    """An id becomes the name of a folder."""
    (tmp_path / "class.csv").write_text(content)
    with pytest.raises(UsageError, match=message):
        read_class(tmp_path / "class.csv")


def test_a_list_may_have_names_with_commas_and_a_mark_of_its_encoding(tmp_path: Path) -> None:
    """As spreadsheets save it."""
    (tmp_path / "class.csv").write_bytes('\ufeffname,ID\n"Zoë, B",z1\n,\n'.encode())
    assert read_class(tmp_path / "class.csv") == ["z1"]


def test_rubrics_of_one_sheet_give_a_student_the_same_numbers() -> None:
    """The milestones of a project, which one program has to pass."""
    third, fourth = (rubric(f"lab-16-{number}").variant(KEY, "s01").numbers for number in (3, 4))
    assert third == fourth != rubric("lab-16-3").variant(KEY, "s02").numbers


def test_expressions_know_numbers_names_and_five_operators_only() -> None:
    """Nothing else of Python."""
    assert filled("x between {a * 2 - 1} and {a / 4}", {"a": 2.0}) == "x between 3 and 0.5"
    assert filled("x at most {(8 * a) ** 0.5}", {"a": 2.0}) == "x at most 4"
    wrong = ("{__import__('os')}", "{b}", "{a % 2}", "{a / 0}", "{a.real}", "{a +}")
    for text in (*wrong, "{a ** 2000}", "{(0 - a) ** 0.5}"):
        with pytest.raises(ValueError, match=r"expected numbers|has no value"):
            filled(text, {"a": 2.0})


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("motor_b_gain}", "gain}", r"checks\[0\].own"),
        ('motors = ["B"]', 'motors = ["C"]', "nothing is plugged into motor port C"),
        ("identify.toml", "none.toml", "there is no file"),
    ],
)
def test_a_wrong_individual_table_is_refused(
    old: str, new: str, message: str, tmp_path: Path
) -> None:
    """With file, line and field, before the first student gets a folder."""
    text = (RUBRICS / "lab-03.toml").read_text().replace("../../../", f"{ROOT}/")
    assert old in text
    (tmp_path / "r.toml").write_text(text.replace(old, new))
    with pytest.raises(ProjectFileError, match=re.escape("r.toml") + ".*" + message):
        read_rubric(tmp_path / "r.toml")
