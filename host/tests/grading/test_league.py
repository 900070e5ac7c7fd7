# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Races with drawn robots and tracks, and the league table that comes of them."""

from __future__ import annotations

import json
import math
import shutil
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from matplotlib.image import imread
from scipy.ndimage import label
from verification.support.paths import ROOT

from ravenbrick.errors import ProjectFileError, RavenbrickError, UsageError
from ravenbrick.grading.league import league_of, pseudonym
from ravenbrick.grading.race import Race, Track
from ravenbrick.grading.rubric import read_rubric
from ravenbrick.project.robot import Floor, read_robot
from ravenbrick.trace.measures import RunMeasures
from ravenbrick.trace.recording import Recording

BENCH = ROOT / "examples" / "motor-bench"
LINE = read_robot(ROOT / "examples" / "line-follower")
LEAGUE = ROOT / "docs" / "lessons" / "rubrics" / "league-line.toml"
RAVENBRICK = [sys.executable, "-c", "from ravenbrick.cli import main; main()"]
SPIN = """schema_version = 1
name = "spin"
seed = 1
duration_ms = 2_500

[[inputs]]
at_ms = 1_000
input = "touch.1"
value = 1
"""
RUBRIC = """schema_version = 1
name = "sprint"
project = "PROJECT"

[[checks]]
name = "once round"
points = 1
scenario = "spin.toml"
hidden_seeds = 2
race.from_ms = 1_000
race.finish = { signal = "motor.B.angle", value = 6.28 }
race.line = { signal = "motor.B.angular_velocity", value = 8.1 }
"""


def floor_of(track: Track, seed: int, folder: Path) -> tuple[Floor, np.ndarray[Any, Any]]:
    """The drawn floor, and its picture with row 0 at the lower edge; True is black."""
    floor = track.floor(LINE, seed, folder).floor
    assert floor is not None
    return floor, imread(floor.image)[::-1, :, 0] < 0.5


@pytest.mark.parametrize("seed", range(6))
def test_a_drawn_track_is_a_closed_line_that_begins_at_the_sensor(
    tmp_path: Path, seed: int
) -> None:
    """White left of the sensor, black on its right, straight ahead too; one area inside."""
    track = Track(0.5, 0.7, 0.03)
    floor, black = floor_of(track, seed, tmp_path)
    pixel, (left, below) = floor.pixel.value, floor.corner

    def dark(x: float, y: float) -> bool:
        return bool(black[int((y - below) / pixel), int((x - left) / pixel)])

    for ahead in (-0.02, 0.0, 0.02):
        assert not dark(0.07 + ahead, 0.008) and dark(0.07 + ahead, -0.008)
        assert not dark(0.07 + ahead, -0.042)
    # It goes straight ahead there, so it is as high before as behind, and turns to the left.
    behind, ahead = (
        pixel * np.flatnonzero(black[:, int((0.07 + far - left) / pixel)])[0] for far in (-0.1, 0.1)
    )
    assert ahead == pytest.approx(behind, abs=0.006)
    assert below + pixel * np.flatnonzero(black.any(axis=1)).mean() > 0.3
    areas, count = label(~black)
    assert count == 2
    sizes = [int((areas == number).sum()) * pixel**2 for number in (1, 2)]
    # The inner area of a circle, and what the harmonics add.
    assert math.pi * 0.48**2 <= min(sizes) <= math.pi * (0.7 * 1.1) ** 2
    again, same = floor_of(track, seed, tmp_path)
    assert again == floor and (same == black).all()
    # The paper goes on as it ends, and its line reflects little.
    shades = imread(floor.image)[:, :, 0]
    assert shades.max() == pytest.approx(floor.outside, abs=1 / 255)
    assert shades.min() == pytest.approx(0.08, abs=1 / 255)
    assert floor_of(track, seed + 6, tmp_path)[1].shape != black.shape


def test_a_seed_draws_a_robot_within_its_tolerances() -> None:
    """Both motors and the battery, others for another seed."""
    race = Race(0, ("body.x", 1.0), ("body.y", 0.0))
    first, second = (race.robot(LINE, seed, Path()) for seed in (1, 2))
    for port in "BC":
        nominal = LINE.motors[LINE.motor_ports[port].motor]
        for name, quantity in first.motors[first.motor_ports[port].motor].items():
            assert nominal[name].allows(quantity.value), name
        assert first.motor_values(port) != second.motor_values(port) != LINE.motor_values(port)
    assert first.motor_values("B") != first.motor_values("C")
    assert first.battery.voltage.value != second.battery.voltage.value
    assert first == race.robot(LINE, 1, Path())


def recorded(**signals: np.ndarray[Any, Any]) -> Recording:
    """Signals of a run that was sampled every millisecond."""
    times = np.arange(1, 4001) * 1e-3
    named = {name.replace("_at_", "."): values for name, values in signals.items()}
    return cast(
        Recording,
        SimpleNamespace(signals=named, signal=lambda name: (times, named[name] + 0 * times)),
    )


def run_of(*tasks: tuple[int | None, int | None, int]) -> RunMeasures:
    """Measures with such tasks: deadline, longest response and misses."""
    rows = [
        SimpleNamespace(name="x", deadline_cycles=d, response_time_cycles_max=r, deadline_misses=m)
        for d, r, m in tasks
    ]
    return cast(RunMeasures, SimpleNamespace(tasks=rows))


def test_a_race_measures_time_deviation_energy_and_margin() -> None:
    """2 V times 0.5 A on each of two motors for 2 s; a sine has its amplitude over root two."""
    times = np.arange(1, 4001) * 1e-3
    run = recorded(
        body_at_x=times - 1.0,
        body_at_y=0.3 + 0.1 * np.sin(2 * math.pi * times),
        motor_at_B_at_voltage=np.array(2.0), motor_at_B_at_current=np.array(0.5),
        motor_at_C_at_voltage=np.array(2.0), motor_at_C_at_current=np.array(0.5),
    )  # fmt: skip
    race = Race(1000, ("body.x", 2.0), ("body.y", 0.3))
    found = race.measure(LINE, run, run_of((1000, 100, 0), (500, 400, 0), (None, 5, 0)))
    assert found["time_s"] == pytest.approx(2.0, abs=2e-3)
    assert found["deviation"] == pytest.approx(0.1 / math.sqrt(2), rel=1e-3)
    assert found["energy_j"] == pytest.approx(4.0, rel=2e-3)
    assert found["deadline_margin"] == pytest.approx(0.2)
    with pytest.raises(RavenbrickError, match=r"did not finish: body\.x"):
        replace(race, finish=("body.x", 4.0)).measure(LINE, run, run_of())
    with pytest.raises(RavenbrickError, match="missed a deadline"):
        race.measure(LINE, run, run_of((1000, 1100, 1)))


def result(name: str, *values: float) -> dict[str, Any]:
    """Of one race; without values it was not finished."""
    keys = ("time_s", "deviation", "energy_j", "deadline_margin")
    row: dict[str, Any] = {"name": "oval", "found": "secret text", "hidden": False}
    how = {"measures": dict(zip(keys, values, strict=True))} if values else {"lost": "too slow"}
    return {"submission": name, "checks": [row | how]}


def test_places_follow_from_the_mean_rank() -> None:
    """Least time, deviation and energy, largest margin; equal scores share a place.

    Checks that are no race change nothing; of two lost races the first is told.
    """
    rubric = read_rubric(LEAGUE)
    rubric = replace(rubric, checks=rubric.checks[:1])
    results = [
        result("a", 10, 0.2, 5, 0.9),  # ranks 1 2 2 1
        result("b", 11, 0.1, 4, 0.8),  # ranks 2 1 1 2
        result("c", 12, 0.3, 6, 0.7),  # ranks 3 3 3 3
        result("d"),
    ]
    league = league_of(rubric, results, list("abcd"))
    assert [(e.name, e.place, e.score) for e in league.entries[:3]] == [
        ("a", 1, 1.5), ("b", 1, 1.5), ("c", 3, 3.0),
    ]  # fmt: skip
    assert (league.entries[3].place, league.entries[3].sentence) == (None, "oval: too slow")
    other = replace(rubric.checks[0], name="builds", kind="builds", value=True)
    row = {"name": "builds", "found": "builds", "hidden": False}
    both = [{**each, "checks": [row, *each["checks"]]} for each in results]
    assert league_of(replace(rubric, checks=(other, *rubric.checks)), both, "abcd") == league
    second = replace(rubric.checks[0], name="lap")
    twice = [{**each, "checks": each["checks"] * 2} for each in results]
    lost = league_of(replace(rubric, checks=(*rubric.checks, second)), twice, "abcd").entries[3]
    assert lost.sentence == "oval: too slow"
    unseen = replace(rubric, checks=(replace(rubric.checks[0], hidden=True),))
    assert league_of(unseen, results, list("abcd")).entries[3].sentence == "oval: did not finish"
    assert "secret text" not in repr(league)
    with pytest.raises(UsageError, match="no check with a 'race'"):
        league_of(replace(rubric, checks=()), [], [])
    with pytest.raises(UsageError, match="two races of one name"):
        league_of(replace(rubric, checks=rubric.checks * 2), [], [])


def rubric_of(folder: Path, text: str = RUBRIC) -> Path:
    """A rubric with a race of the motor bench, and its scenario beside it."""
    folder.mkdir(exist_ok=True)
    (folder / "spin.toml").write_text(SPIN)
    (folder / "sprint.toml").write_text(text.replace("PROJECT", str(BENCH)))
    return folder / "sprint.toml"


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ('"spin.toml"', '"spin.toml"\nrace.track = { least_m = 1, most_m = 1, width_m = 0.03 }',
         r"sprint\.toml:\d+: checks\[0\]\.race: there is no \[floor\]"),
        ("race.from_ms = 1_000\n", "", r"checks\[0\]\.race\.from_ms: is missing"),
        ("hidden_seeds = 2", "hidden_seeds = 2\nbuilds = true", "expected exactly one of"),
    ],
)  # fmt: skip
def test_a_wrong_race_is_refused_where_it_stands(
    tmp_path: Path, old: str, new: str, said: str
) -> None:
    """File, line and field."""
    with pytest.raises(ProjectFileError, match=said):
        read_rubric(rubric_of(tmp_path, RUBRIC.replace(old, new)))


def submitted(folder: Path, **changes: tuple[str, str, str]) -> None:
    """Submissions with the motor bench's sources, each with a change of a file."""
    for name, (file, old, new) in changes.items():
        for part in ("src", "generated"):
            shutil.copytree(BENCH / part, folder / name / part)
        place = folder / name / file
        text = place.read_text()
        assert old in text
        place.write_text(text.replace(old, new))


def test_the_same_submissions_make_the_same_page(tmp_path: Path) -> None:
    """Whatever the number of workers; no name, no source text and no secret is on it."""
    stops = 'raise Program_Error with "my private text";'
    submitted(
        tmp_path / "all",
        zoe=("src/bench.adb", "Target_Angle : constant := 360;", "Target_Angle : constant := 361;"),
        slow=("src/bench.adb", "100.0 * Now.Control", "60.0 * Now.Control"),
        syntax=("src/bench.adb", "end Bench;", "end My_Secret_Name;"),
        fault=("src/bench.adb", "Speed_Controller.Initialize (Work);", stops),
    )
    rubric, pages, answers = rubric_of(tmp_path / "rubric"), [], []
    for workers in ("1", "3"):
        page = tmp_path / f"league-{workers}.html"
        command = [*RAVENBRICK, "grade", str(tmp_path / "all"), "--rubric", str(rubric)]
        command += ["--secret", "a secret text", "--workers", workers, "--json"]
        command += ["--output", str(tmp_path / workers), "--league", str(page)]
        done = subprocess.run(command, capture_output=True, text=True)
        assert done.returncode == 0, done.stdout + done.stderr
        pages.append(page.read_text())
        answers.append(json.loads(done.stdout))
    assert pages[0] == pages[1] and answers[0] == answers[1]
    names = {r["submission"]: r["pseudonym"] for r in answers[0]["results"]}
    assert names["zoe"] == pseudonym("zoe", "a secret text") != pseudonym("zoe", "another")
    table = {e["name"]: (e["place"], e["sentence"]) for e in answers[0]["league"]["entries"]}
    assert [table[names[n]][0] for n in ("zoe", "slow", "syntax", "fault")] == [1, 2, None, None]
    assert table[names["syntax"]][1].endswith("it could not be read or built")
    assert table[names["fault"]][1].endswith("the program failed")
    for word in ("zoe", "My_Secret_Name", "my private text", "a secret text", "bench.adb"):
        assert word not in pages[0]
    for alias in names.values():
        assert alias in pages[0]
    named = tmp_path / "named.html"
    command += ["--league", str(named), "--league-names"]
    assert subprocess.run(command, capture_output=True).returncode == 0
    assert "zoe" in named.read_text() and names["zoe"] not in named.read_text()
