# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Reference models of FMI's authors as plants: the results that they publish with them."""

from __future__ import annotations

import csv
import os
import subprocess
from pathlib import Path

import numpy as np
import pytest
from ravenbrick.model import FmuPlant, Simulation

from verification.support.fmu.units import packed

FOLDER = os.environ.get("RAVENBRICK_REFERENCE_FMUS")


def built(source: Path, name: str, version: int, folder: Path) -> Path:
    """The unit of a model for a version of FMI."""
    library = folder / f"{name}.so"
    own = (source / f"src/fmi{version}Functions.c", source / "src/cosimulation.c")
    command = ["gcc", "-O1", "-fPIC", "-shared", "-w", f"-DFMI_VERSION={version}"]
    command += ["-DDISABLE_PREFIX", f"-I{source / 'include'}", f"-I{source / name}"]
    files = map(str, (*own, source / name / "model.c"))
    subprocess.run([*command, *files, "-lm", "-o", str(library)], check=True)
    description = (source / name / f"FMI{version}.xml").read_text(encoding="utf-8")
    return packed(library, name, version, description)


@pytest.mark.skipif(FOLDER is None, reason="RAVENBRICK_REFERENCE_FMUS names no checkout")
@pytest.mark.parametrize("version", [2, 3])
@pytest.mark.parametrize("name", ["BouncingBall", "Dahlquist", "VanDerPol"])
def test_a_reference_model_gives_the_published_results(
    name: str, version: int, tmp_path: Path
) -> None:
    """The models integrate by Euler's method, with a step of their own."""
    pytest.importorskip("fmpy", reason="optional: pip install -r tools/requirements/fmu.txt")
    source = Path(str(FOLDER))
    with (source / name / f"{name}_out.csv").open(encoding="utf-8") as file:
        names, *rows = csv.reader(file)
    published = np.array(rows, dtype=float)
    plant = FmuPlant(built(source, name, version, tmp_path), outputs=names[1:])
    found = Simulation(None, plant).run(published[-1, 0])
    assert len(published) > 20
    for place, output in enumerate(names[1:], 1):
        ours = [found[f"plant/{output}"].at(time) for time in published[:, 0]]
        assert ours == pytest.approx(published[:, place], rel=1e-9, abs=1e-12)
