# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Models that Embedded Coder generated for others, through the binding that we write for them.

RAVENBRICK_CODER_MODELS names a folder with one folder `<name>_ert_rtw` or the like per model, as
public repositories hold them. None of their files is part of this project.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from ravenbrick.codegen import CoderModel, read_binding, read_coder_model

from verification.support.bricks.observe import Brick, bench
from verification.support.codegen.coder_check import compare_with_direct_calls

HERE = Path(__file__).resolve().parent
VEHICLE = HERE.parent.parent / "examples" / "vehicle"
FOLDER = os.environ.get("RAVENBRICK_CODER_MODELS", "")
MODELS = sorted(path for path in Path(FOLDER).iterdir() if path.is_dir()) if FOLDER else []
NONE = "RAVENBRICK_CODER_MODELS does not name a folder with models of Embedded Coder"
# The example of a main program holds the parameters where no other file does.
EXAMPLE_PARAMETERS = re.compile(r"static (P\w* \w+ = \{.*?\n\};)", re.DOTALL)

pytestmark = pytest.mark.skipif(not MODELS, reason=NONE)


def model_in(source: Path, folder: Path) -> CoderModel:
    """The model, with the parameters of its example of a main program if only that has some."""
    copied = folder / source.name
    shutil.copytree(source, copied)
    model = read_coder_model(copied)
    example = copied / "ert_main.c"
    if "parameters" not in model.interface.types or "parameters" in model.interface.symbols:
        return model
    found = EXAMPLE_PARAMETERS.search(example.read_text()) if example.is_file() else None
    if found is not None:
        (copied / "parameters.c").write_text(f'#include "{model.header}"\n{found[1]}\n')
    return read_coder_model(copied)


@pytest.mark.parametrize("source", MODELS or [Path()], ids=lambda path: path.name)
def test_a_model_gives_the_same_bits_through_its_binding(source: Path, tmp_path: Path) -> None:
    """Two instances on the virtual brick, step by step in turn, against the C called directly."""
    (tmp_path / "work").mkdir()
    result = compare_with_direct_calls(model_in(source, tmp_path), tmp_path / "work")
    assert result.differing == 0
    assert result.compared > 0 and result.distinct > 1


def vehicle_image(folder: Path, generated: Path | None) -> bytes:
    """The vehicle as `make` builds it, optionally with other generated files."""
    command = ["make", "-C", str(VEHICLE), "ram", f"PYTHON={sys.executable}"]
    own = {"RAVENBRICK_BUILD": str(folder)}
    own |= {"GENERATED": str(generated)} if generated else {}
    done = subprocess.run(
        command, capture_output=True, text=True, check=False, env=os.environ | own
    )
    assert done.returncode == 0, done.stdout[-2000:] + done.stderr
    return (folder / "vehicle" / "ram" / "vehicle.elf").read_bytes()


def speeds(image: bytes) -> list[float]:
    """The left wheel's speed in volts after a step to 4 V, every 4 ms."""
    import json

    import virtual_brick

    device = Brick(virtual_brick.VirtualBrick(json.dumps(bench()), image))
    device.set(550, "button.right", 1)
    device.set(600, "touch.1", 1)
    device.set(700, "touch.1", 0)
    found = []
    for at in range(600, 1_800, 4):
        device.run(at)
        found.append(device.number("vehicle_speed_left"))
    return found


PIDS = [path for path in MODELS if path.name.startswith("pid")]


@pytest.mark.parametrize("source", PIDS or [Path()], ids=lambda path: path.name)
def test_a_real_pid_drives_the_vehicle_as_ours_does(source: Path, tmp_path: Path) -> None:
    """In place of ours, by the same command: the same gains give the same step response."""
    if not PIDS:
        pytest.skip("no model of a PID (a folder pid...) is in RAVENBRICK_CODER_MODELS")
    generated = tmp_path / "generated"
    generated.mkdir()
    shutil.copy(VEHICLE / "generated" / "controller_design.ads", generated)
    files = model_in(source, tmp_path).files_with_binding(read_binding(HERE / "pid.toml"))
    for name, text in files.items():
        (generated / name).write_text(text)
    theirs = speeds(vehicle_image(tmp_path / "theirs", generated))
    ours = speeds(vehicle_image(tmp_path / "ours", None))
    assert max(ours) > 3.5
    assert theirs == pytest.approx(ours, abs=0.3)
    assert sum(theirs[-100:]) / 100 == pytest.approx(4.0, abs=0.05)
