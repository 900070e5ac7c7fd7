# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Models of other tools as plants: FMPy's own simulation, and the same motor in SciPy's solver."""

from __future__ import annotations

import zipfile
from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from verification.support.fmu.units import flywheel

from ravenbrick.errors import DesignError, RunFaultError, UsageError
from ravenbrick.model import (
    NXT_MOTOR,
    Diagram,
    FmuPlant,
    Gain,
    Inport,
    Outport,
    Recording,
    Saturation,
    Simulation,
    Sum,
    motor_plant,
)

Build = Callable[..., Path]
FIXED_STEP = {'canHandleVariableCommunicationStepSize="true"': ""}
NO_FLYWHEEL = "-DFLYWHEEL=0.0"
FIRST_VERSION = """<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="1.0" modelName="old" modelIdentifier="old" guid="{old}"
                     numberOfContinuousStates="0" numberOfEventIndicators="0">
  <ModelVariables/>
  <Implementation>
    <CoSimulation_StandAlone><Capabilities/></CoSimulation_StandAlone>
  </Implementation>
</fmiModelDescription>
"""

pytestmark = pytest.mark.long("needs FMPy")


@pytest.fixture
def build(tmp_path: Path) -> Build:
    """Builds the flywheel for a version of FMI."""
    pytest.importorskip("fmpy", reason="optional: pip install -r tools/requirements/fmu.txt")
    return partial(flywheel, tmp_path)


def position_loop() -> Diagram:
    """An angle held by a cut voltage, at 10 ms."""
    d = Diagram("functional", 0.01)
    error = d.add(Sum("Error", signs="+-"))
    d.connect(d.add(Inport("wanted")), error, 0)
    d.connect(d.add(Inport("angle_B")), error, 1)
    d.connect_chain(error, d.add(Gain("Kp", gain=4.0)), d.add(Saturation("Cut", limit=7.0)),
                    d.add(Outport("voltage_B")))  # fmt: skip
    return d


def driven(plant: FmuPlant) -> Recording:
    """A second of the loop; a voltage arrives 2.5 ms after its sample."""
    return Simulation(position_loop(), plant, latency=0.0025).run(1.0, {"wanted": 2.0})


def test_a_unit_in_the_loop_comes_to_the_motor_in_the_loop_as_its_step_shrinks(
    build: Build,
) -> None:
    """The unit integrates by Euler's method: a tenth of the step leaves a tenth of the error."""
    lines = {"angle_B": "angle", "voltage": "voltage_B"}
    own = Simulation(position_loop(), motor_plant("motor", NXT_MOTOR), lines=lines, latency=0.0025)
    wanted = own.run(1.0, {"wanted": 2.0})["functional/angle_B"].values
    for version in (2, 3):
        unit = build(version, NO_FLYWHEEL)
        coarse, fine = (
            driven(FmuPlant(unit, step=step))["functional/angle_B"].values for step in (1e-3, 1e-4)
        )
        errors = [np.abs(found - wanted).max() for found in (coarse, fine)]
        assert errors[1] < 1.5e-3 and errors[0] / errors[1] == pytest.approx(10.0, rel=0.2)


def test_a_unit_alone_is_what_fmpy_simulates(build: Build) -> None:
    """With its ports, its units and, where none is given, the step of 1 ms."""
    import fmpy

    unit = build(3)
    found = Simulation(None, FmuPlant(unit)).run(0.5, {"voltage_B": 6.0})
    theirs = fmpy.simulate_fmu(
        str(unit), stop_time=0.5, step_size=1e-3, output_interval=1e-3, output=["angle_B"],
        start_values={"voltage_B": 6.0},
    )  # fmt: skip
    angle = found["plant/angle_B"]
    assert angle.unit == "rad" and found["plant/voltage_B"].values[-1] == 6.0
    at_steps = [angle.at(time) for time in theirs["time"]]
    assert len(at_steps) == 501
    assert at_steps == pytest.approx(theirs["angle_B"], rel=1e-9)


def test_each_run_begins_anew(build: Build) -> None:
    loop = Simulation(position_loop(), FmuPlant(build(2), step=0.0005), latency=0.0025)
    first, second = (loop.run(0.3, {"wanted": 1.0})["plant/angle_B"].values for _ in range(2))
    assert first[0] == 0.0 and first[-1] > 0.1
    assert first.tolist() == second.tolist()


def test_a_unit_with_steps_of_one_length_needs_sample_times_and_latency_to_fit(
    build: Build,
) -> None:
    unit = build(2, NO_FLYWHEEL, replaced=FIXED_STEP)
    with pytest.raises(DesignError, match=r"0\.001 s do not divide the time from 0 to 0\.0025 s"):
        driven(FmuPlant(unit, step=1e-3))
    free = build(3, NO_FLYWHEEL)
    fixed = driven(FmuPlant(unit, step=5e-4))["plant/angle_B"].values
    assert fixed.tolist() == driven(FmuPlant(free, step=5e-4))["plant/angle_B"].values.tolist()


def test_what_does_not_fit_is_named(build: Build) -> None:
    with pytest.raises(UsageError, match=r"no real number 'speed'; its inputs are voltage_B, its"):
        Simulation(None, FmuPlant(build(2), outputs=("speed",))).run(0.1)
    with pytest.raises(DesignError, match="no input 'volts'; there are: voltage_B"):
        Simulation(None, FmuPlant(build(2))).run(0.1, {"volts": 1.0})
    with pytest.raises(RunFaultError, match=r"fmu: terminated the simulation at 0\.05\d+ s"):
        driven(FmuPlant(build(3, "-DENDS_AT=0.05")))
    with pytest.raises(DesignError, match="the step must be > 0 s, not 0"):
        FmuPlant(Path("some.fmu"), step=0)


def test_units_of_the_first_version_are_refused(build: Build, tmp_path: Path) -> None:
    old = tmp_path / "old.fmu"
    with zipfile.ZipFile(old, "w") as archive:
        archive.writestr("modelDescription.xml", FIRST_VERSION)
    with pytest.raises(UsageError, match=r"is of FMI 1\.0; export it for FMI 2 or 3"):
        Simulation(None, FmuPlant(old)).run(0.1)
