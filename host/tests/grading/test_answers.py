# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Numbers that are handed in beside the program."""

from __future__ import annotations

from pathlib import Path

import pytest
from verification.support.paths import ROOT

from ravenbrick.errors import ProjectFileError
from ravenbrick.grading.answers import parse_wanted, read_answers
from ravenbrick.grading.campaign import run_campaign
from ravenbrick.grading.rubric import read_rubric
from ravenbrick.grading.submission import Submission, find_submissions

RUBRIC = f"""
schema_version = 1
name = "numbers"
project = "{ROOT / "examples" / "blank"}"

[[checks]]
name = "gain"
points = 3
answer = "gain between 1.9 and 2.1"

[[checks]]
name = "friction"
points = 1
answer = "friction at most 0.2"
"""


@pytest.mark.parametrize(
    ("text", "value", "met"),
    [
        ("gain between 1.9 and 2.1", "2", True),
        ("gain between 1.9 and 2.1", "2.2", False),
        ("gain at least -1e-3", "-0.001", True),
        ("gain at most 5", "5.1", False),
    ],
)
def test_a_number_is_met_within_its_bounds(text: str, value: str, met: bool) -> None:
    """Bounds belong to what is right; whole numbers are numbers."""
    answers = read_answers(f"gain = {value}\n".encode())
    assert parse_wanted(text).judge(answers)[0] is met


@pytest.mark.parametrize(
    ("content", "found"),
    [
        (None, "there is no answers.toml"),
        (b"other = 2\n", "has no 'gain'"),
        (b'gain = "two"\n', "expected a number"),
        (b"gain = true\n", "expected a number"),
        (b"gain = nan\n", "gain = nan"),
        (b"gain = " + b"9" * 400 + b"\n", "the number is too large"),
        (b"gain = = 2\n", "answers.toml: "),
        (b"\xff\xfe\n", "answers.toml: "),
        (b"gain = 2\n" + 20_000 * b"#..\n", "answers.toml is larger than 64 KB"),
        (b"a." * 20_000 + b"gain = 2\n", "answers.toml: a key of more than 50 parts"),
        (b"a = " + b"[" * 5000 + b"\n", "answers.toml: "),
    ],
)
def test_what_is_no_answer_gets_no_points(content: bytes | None, found: str) -> None:
    """And the reason is told, whatever was handed in."""
    met, told = parse_wanted("gain between 1.9 and 2.1").judge(read_answers(content))
    assert not met and found in told


def test_a_rubric_of_numbers_builds_nothing(tmp_path: Path) -> None:
    """A folder with answers alone is graded; each number counts for itself."""
    (tmp_path / "rubric.toml").write_text(RUBRIC)
    (tmp_path / "all" / "ada").mkdir(parents=True)
    (tmp_path / "all" / "ada" / "answers.toml").write_text("gain = 2.03\nfriction = 0.3\n")
    rubric = read_rubric(tmp_path / "rubric.toml")
    found = find_submissions([tmp_path / "all"])
    assert (
        found
        == find_submissions([tmp_path / "all" / "ada"])
        == [Submission("ada", tmp_path / "all" / "ada")]
    )
    (result,) = run_campaign(rubric, found, tmp_path / "out", workers=1)
    assert (result["points"], result["of"]) == (3, 4)
    assert [row["found"] for row in result["checks"]] == ["gain = 2.03", "friction = 0.3"]
    assert not (tmp_path / "out" / "cache").exists()


def test_a_wrong_question_is_told_with_its_line(tmp_path: Path) -> None:
    """Of the rubric."""
    file = tmp_path / "rubric.toml"
    file.write_text(RUBRIC.replace("gain between 1.9 and 2.1", "gain about 2"))
    with pytest.raises(ProjectFileError, match=r"rubric.toml:9: checks\[0\].answer: .gain about"):
        read_rubric(file)
