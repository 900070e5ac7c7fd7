# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""An FMU in place of the body: the brick's own firmware turns and measures its motor."""

from __future__ import annotations

import json
from collections.abc import Callable
from functools import partial
from pathlib import Path

import pytest
from typer.testing import CliRunner
from verification.support.bricks.nxt_firmware import CONFIGURATION, encoder, firmware_brick, run_ms
from verification.support.fmu.units import flywheel

from ravenbrick.brick.fmu_body import CoSimulation, FmuBody
from ravenbrick.brick.links.peers import UsbComputer
from ravenbrick.brick.links.telegrams import UsbTelegrams
from ravenbrick.cli.app import app
from ravenbrick.errors import RunFaultError, UsageError

BENCH = Path(__file__).resolve().parents[3] / "examples" / "motor-bench"
MENU_MS = 6_000
Build = Callable[..., Path]

pytestmark = pytest.mark.long("needs FMPy")


@pytest.fixture
def build(tmp_path: Path) -> Build:
    """Builds the flywheel for a version of FMI."""
    pytest.importorskip("fmpy", reason="optional: pip install -r tools/requirements/fmu.txt")
    return partial(flywheel, tmp_path)


def driven(path: Path) -> tuple[float, float, str]:
    """Tacho edges of the firmware and of the encoder after a second at 80 %, and the digest."""
    import nxt.brick
    import nxt.motor

    body = FmuBody(path)
    brick = firmware_brick(**body.configuration(CONFIGURATION))
    run_ms(brick, MENU_MS)
    joined = CoSimulation(brick, body)
    try:
        with nxt.brick.Brick(UsbTelegrams(UsbComputer(joined))) as remote:
            motor = remote.get_motor(nxt.motor.Port.B)
            motor.run(80)
            run_ms(joined, 1000)
            motor.idle()
            run_ms(joined, 5)
            count = motor.get_tacho().tacho_count
        return count, encoder(brick, "B"), brick.trace_digest()
    finally:
        body.close()


def test_firmware_turns_and_measures_units_of_fmi_2_and_3_in_the_same_run(build: Build) -> None:
    count, edges, digest = driven(build(2))
    # The flywheel's time constant is inertia * R / (Kt Ke) = 0.22 s; 80 % of 8 V give 13.4 rad/s.
    assert 500 < count < 720
    assert abs(count - edges) <= 3
    assert driven(build(3)) == (count, edges, digest)


def test_a_unit_that_ends_itself_ends_the_run_with_words(build: Build) -> None:
    body = FmuBody(build(3, "-DENDS_AT=0.001"))
    joined = CoSimulation(firmware_brick(**body.configuration(CONFIGURATION)), body)
    with pytest.raises(RunFaultError, match=r"fmu: terminated the simulation at 0\.00\d+ s"):
        run_ms(joined, 10)


def test_the_motor_bench_runs_with_the_unit_as_with_its_own_body(build: Build) -> None:
    def ravenbrick(*arguments: str) -> dict[str, object]:
        result = CliRunner().invoke(app, [*arguments, "--json"])
        assert result.exit_code == 0, result.output
        answer: dict[str, object] = json.loads(result.output)
        return answer

    ravenbrick("build", str(BENCH))
    own = ravenbrick("run", str(BENCH), "step")
    unit = str(build(3, "-DFLYWHEEL=0.0"))
    outside = ravenbrick("run", str(BENCH), "step", "--body", unit)
    for ours, theirs in zip(measures(own), measures(outside), strict=True):
        assert theirs == pytest.approx(ours, rel=0.03, abs=0.005)
    assert own["trace_digest"] != outside["trace_digest"]


def measures(answer: dict[str, object]) -> list[float]:
    """Settling time, overshoot: what the scenario measures of the shaft."""
    criteria = answer["criteria"]
    assert isinstance(criteria, list)
    return [float(one["value"]) for one in criteria if one["value"] is not None]


def test_a_snapshot_of_a_run_with_a_unit_is_refused(build: Build, tmp_path: Path) -> None:
    arguments = ["run", str(BENCH), "step", "--body", str(build(2)), "--save-snapshot"]
    result = CliRunner().invoke(app, [*arguments, str(tmp_path / "kept.rbs")])
    assert result.exit_code == 2
    assert "omit --body" in result.output


def test_what_is_no_unit_for_motors_is_refused_with_words(tmp_path: Path, build: Build) -> None:
    with pytest.raises(UsageError, match="no such file"):
        FmuBody(tmp_path / "absent.fmu")
    damaged = tmp_path / "damaged.fmu"
    damaged.write_bytes(b"PK\3\4 nothing")
    with pytest.raises(UsageError, match="cannot be read as an FMU"):
        FmuBody(damaged)
    with pytest.raises(UsageError, match="voltage_A"):
        FmuBody(build(3, replaced={"angle_B": "shaft"}))
    with pytest.raises(UsageError, match="port B"):
        FmuBody(build(2)).configuration({"motors": {}})
