# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""What other commands read of the file that `ravenbrick analyse` writes."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from ravenbrick.errors import ProjectFileError, UsageError
from ravenbrick.image.elf import ElfImage
from ravenbrick.timing.results.bounds_file import own_bounds, own_worst_paths, read_bounds

IMAGE = ElfImage(Path("robot.elf"), b"this one", "ram", 0, (), {})
OTHER = ElfImage(Path("robot.elf"), b"another", "ram", 0, (), {})


def part(place: str, times: int, cycles: int, run: int) -> dict[str, object]:
    """A line as one call executes it."""
    return {"place": place, "worst_times": times, "worst_cycles": cycles, "run_cycles": run}


def written(folder: Path) -> Path:
    """A file for `IMAGE`: one task with a bound and two lines, one of them of two calls."""
    path = [part("a.adb:3", 2, 40, 30), part("a.adb:9", 1, 95, 50), part("a.adb:3", 5, 60, 20)]
    content = {
        "image_sha256": IMAGE.digest,
        "tasks": [
            {"name": "brake", "response_bound_cycles": 900},
            {"name": "unbounded", "response_bound_cycles": None},
        ],
        "worst_paths": {"brake": path},
    }
    file = folder / "timing.json"
    file.write_text(json.dumps(content))
    return file


def test_lines_of_a_worst_path_are_summed_over_calls_the_most_expensive_first(
    tmp_path: Path,
) -> None:
    found = own_worst_paths(written(tmp_path), IMAGE)
    assert found == {
        "brake": [
            {"place": "a.adb:3", "times": 7, "cycles": 100, "run_cycles": 50},
            {"place": "a.adb:9", "times": 1, "cycles": 95, "run_cycles": 50},
        ]
    }


def test_bounds_are_those_of_this_image_only(tmp_path: Path) -> None:
    """Another build has other times; without a file there are none."""
    file = written(tmp_path)
    assert read_bounds(file, IMAGE) == own_bounds(file, IMAGE) == {"brake": 900}
    assert own_bounds(file, OTHER) == {} == own_worst_paths(file, OTHER)
    with pytest.raises(UsageError, match="bounds another image than robot"):
        read_bounds(file, OTHER)
    none = tmp_path / "none.json"
    assert own_bounds(none, IMAGE) == {} == own_worst_paths(none, IMAGE)
    with pytest.raises(UsageError, match="there is no such file"):
        read_bounds(none, IMAGE)


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (b"{\n]", r"timing\.json:2: .*no JSON"),
        (b"\xff", r"not UTF-8"),
        (b"{}", r"image_sha256: is missing"),
        (b'{"image_sha256": "", "tasks": [{"name": 1, "response_bound_cycles": "x"}]}', "tasks: "),
        (b'{"image_sha256": "", "tasks": 5}', "tasks: "),
        (b"[" * 100_000, "tasks: too many values inside each other"),
        (
            b'{"image_sha256": "", "tasks": [{"name": 1, "response_bound_cycles": 1e999}]}',
            "infinity",
        ),
    ],
)
def test_a_file_of_something_else_is_refused_with_its_place(
    content: bytes, said: str, tmp_path: Path
) -> None:
    file = tmp_path / "timing.json"
    file.write_bytes(content)
    with pytest.raises(ProjectFileError, match=said):
        read_bounds(file, IMAGE)
