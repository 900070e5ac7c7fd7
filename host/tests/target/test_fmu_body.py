# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""An FMU in place of the body: the brick's own firmware turns and measures its motor."""

from __future__ import annotations

import shutil
import subprocess
import zipfile
from pathlib import Path

import pytest
from host.tests.support.nxt_firmware import CONFIGURATION, encoder, firmware_brick, run_ms
from host.tests.support.nxt_sockets import UsbSocket

from ravenbrick.errors import UsageError
from ravenbrick.target.fmu_body import CoSimulation, FmuBody
from ravenbrick.target.peers import UsbComputer

SOURCES = Path(__file__).parent / "fmu"
MENU_MS = 6_000


@pytest.fixture
def flywheel(tmp_path: Path) -> Path:
    """The FMU of `fmu/`, built with the computer's C compiler."""
    pytest.importorskip("fmpy", reason="optional: pip install -r tools/requirements-fmu.txt")
    library = tmp_path / "flywheel.so"
    command = ["gcc", "-O1", "-fPIC", "-shared", "-Wall", "-Werror", "-o", str(library)]
    subprocess.run([*command, str(SOURCES / "flywheel.c")], check=True)
    unit = tmp_path / "flywheel.fmu"
    with zipfile.ZipFile(unit, "w") as archive:
        archive.write(SOURCES / "modelDescription.xml", "modelDescription.xml")
        archive.write(library, "binaries/linux64/flywheel.so")
    return unit


def driven(path: Path) -> tuple[float, float, str]:
    """Tacho edges of the firmware and of the encoder after a second at 80 %, and the digest."""
    import nxt.brick
    import nxt.motor

    body = FmuBody(path)
    brick = firmware_brick(**body.configuration(CONFIGURATION))
    run_ms(brick, MENU_MS)
    joined = CoSimulation(brick, body)
    try:
        with nxt.brick.Brick(UsbSocket(UsbComputer(joined))) as remote:
            motor = remote.get_motor(nxt.motor.Port.B)
            motor.run(80)
            run_ms(joined, 1000)
            motor.idle()
            run_ms(joined, 5)
            count = motor.get_tacho().tacho_count
        return count, encoder(brick, "B"), brick.trace_digest()
    finally:
        body.close()


def test_firmware_turns_and_measures_the_unit_and_a_second_run_is_the_same(flywheel: Path) -> None:
    count, edges, digest = driven(flywheel)
    # The flywheel's time constant is inertia * R / (Kt Ke) = 0.22 s; 80 % of 8 V give 13.4 rad/s.
    assert 500 < count < 720
    assert abs(count - edges) <= 3
    assert driven(flywheel) == (count, edges, digest)


def test_what_is_no_unit_for_motors_is_refused_with_words(tmp_path: Path, flywheel: Path) -> None:
    with pytest.raises(UsageError, match="no such file"):
        FmuBody(tmp_path / "absent.fmu")
    damaged = tmp_path / "damaged.fmu"
    damaged.write_bytes(b"PK\3\4 nothing")
    with pytest.raises(UsageError, match="cannot be read as an FMU"):
        FmuBody(damaged)
    nameless = tmp_path / "nameless.fmu"
    shutil.copy(flywheel, nameless)
    text = (SOURCES / "modelDescription.xml").read_text().replace("angle_B", "shaft")
    with zipfile.ZipFile(nameless, "w") as archive:
        archive.writestr("modelDescription.xml", text)
    with pytest.raises(UsageError, match="voltage_A"):
        FmuBody(nameless)
    with pytest.raises(UsageError, match="port B"):
        FmuBody(flywheel).configuration({"motors": {}})
