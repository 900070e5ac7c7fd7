# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The tree's own Ada: style and warnings, which a student's build neither checks nor shows."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest
from ravenbrick.image.build_settings import Settings
from ravenbrick.image.run_time import COMPILER, run_time_library
from ravenbrick.project.robot import read_robot

ROOT = Path(__file__).resolve().parents[2]
EXAMPLES = ROOT / "examples"
DRIVERS = [
    *sorted((ROOT / "drivers" / "src").iterdir()),
    *(ROOT / "drivers" / name for name in ("generated", "configuration")),
]
SWITCHES = ("-c", "-gnatc", "-gnat2012", "-gnatwa", "-gnatw.X", "-gnaty3aAbcefhiklnprtuM100")
# What an example takes from another one.
SHARED = ("remote-vehicle/protocol", "vehicle/src", "vehicle/generated")
REMOTE = [EXAMPLES / name for name in SHARED]
FOLDERS = [
    *DRIVERS,
    *sorted(p for p in EXAMPLES.glob("*/*") if p.name in ("src", "generated", "protocol")),
    *sorted(p.parent for p in EXAMPLES.glob("devices/*/*.adb")),
]


def complaints(sources: list[Path], folders: list[Path], place: Path) -> str:
    """What the compiler says to sources that see these folders."""
    library = run_time_library(Settings.of(read_robot(EXAMPLES / "blank"), {}))
    command = [COMPILER, *SWITCHES, f"--RTS={library}", "-mcpu=arm7tdmi"]
    command += [f"-I{folder}" for folder in (*folders, *DRIVERS)]
    done = subprocess.run(
        [*command, *map(str, sources)], cwd=place, capture_output=True, text=True, check=False
    )
    return done.stderr


@pytest.mark.parametrize("folder", FOLDERS, ids=lambda p: str(p.relative_to(ROOT)))
def test_no_source_of_the_tree_has_a_warning(folder: Path, tmp_path: Path) -> None:
    """Each body, and each specification that has none."""
    sources = [s for s in folder.glob("*.ad[bs]") if not s.with_suffix(".adb").exists()]
    sources += folder.glob("*.adb")
    own = [folder.parent / name for name in ("src", "generated", "protocol")]
    assert complaints(sources, [folder, *own, *REMOTE], tmp_path) == ""


def test_style_and_warnings_are_told(tmp_path: Path) -> None:
    """The check can fail."""
    source = tmp_path / "wrong.adb"
    source.write_text("with System;\nprocedure Wrong is\nbegin\n  null;\nend Wrong;\n")
    said = complaints([source], [tmp_path], tmp_path)
    assert "bad indentation" in said and 'unit "System" is not referenced' in said
