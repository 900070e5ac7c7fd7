# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Fixed-point C and its proof: formats, bits, bounds, and the bounds against simulation."""

from __future__ import annotations

import ctypes
import json
import shutil
from pathlib import Path

import numpy as np
import pytest
from verification.support.codegen.c_build import ARM, WARNINGS, host_library, run
from verification.support.codegen.fixed_point_cases import CASES, anti_windup
from verification.support.codegen.paper_pi import LOOP, fixed_pi, paper_pi, plant

from ravenbrick.codegen import (
    check_program,
    check_with_gappa,
    gappa_script,
    generate_ada,
    generate_c,
    generate_fixed_c,
    prove,
    random_vectors,
)
from ravenbrick.errors import DesignError
from ravenbrick.model import (
    Block,
    Diagram,
    Execution,
    FixedFormat,
    FixedPoint,
    FixedPointOptions,
    Gain,
    Inport,
    IntegrationMethod,
    Outport,
    Relay,
    Rounding,
    Sum,
    to_fixed_point,
)
from ravenbrick.model.program import Kind

STEPS = 3000


@pytest.mark.parametrize("name", CASES)
def test_the_integer_c_equals_the_fixed_point_simulation_bit_for_bit(
    name: str, tmp_path: Path
) -> None:
    """Random steps over all 16-bit inputs, with all warnings as errors."""
    program = CASES[name].program
    generate_c(program).write(tmp_path)
    vectors = random_vectors(program, STEPS, seed=5)
    assert len(np.unique(vectors.outputs)) > STEPS / 20
    (tmp_path / "check.c").write_text(check_program(vectors))
    (tmp_path / "ports.c").write_text(
        f'#include "{program.name}.h"\nExternalInputs_{program.name} {program.name}_U;\n'
        f"ExternalOutputs_{program.name} {program.name}_Y;\n"
    )
    library = host_library(tmp_path, f"{program.name}.c", "check.c", "ports.c")
    getattr(library, f"{program.name}_check")()
    assert ctypes.c_uint32.in_dll(library, f"{program.name}_check_steps").value == STEPS
    assert ctypes.c_uint32.in_dll(library, f"{program.name}_check_failures").value == 0


def test_the_formats_follow_from_the_ranges() -> None:
    """10 V and 20 rad/s give the formats of the hand-made controller, the integrator is exact."""
    fixed = fixed_pi()
    expected = {
        (Kind.INPUT, "Input_Voltage"): "sfix16_En11",
        (Kind.INPUT, "Speed"): "sfix16_En10",
        (Kind.OUTPUT, "correctedvoltage"): "sfix16_En11",
        (Kind.PARAMETER, "Kp"): "sfix16_En15",
        (Kind.PARAMETER, "Ki_Ts"): "sfix16_En15",
        (Kind.STATE, "Integral_DSTATE"): "sfix32_En26",
        (Kind.SIGNAL, "Real_Voltage"): "sfix16_En11",
        (Kind.SIGNAL, "Demand"): "sfix32_En26",
    }
    assert {name: str(fixed.format(*name)) for name in expected} == expected
    raw = {slot.name: slot.initial for slot in fixed.program.parameters}
    assert (raw["Kp"], raw["Ki_Ts"], raw["Scale"]) == (11832, 1279, 16185)


def test_the_closed_loop_bound_is_the_published_one() -> None:
    """Peak gains 1.000, 1.153 and 25.62; 2.153 LSB = 1.051 mV for all time."""
    bound = prove(fixed_pi(), plant()).closed_loop
    assert bound is not None
    assert bound.peak_gain("Real_Voltage", "signal") == pytest.approx(1.000, abs=5e-4)
    assert bound.peak_gain("correctedvoltage", "output") == pytest.approx(1.153, abs=5e-4)
    assert bound.peak_gain("Integral", "state") == pytest.approx(25.62, abs=5e-3)
    assert bound.rounding * 2048 == pytest.approx(2.153, abs=5e-4)
    assert bound.rounding == pytest.approx(1.051e-3, abs=5e-7)
    assert bound.total == pytest.approx(bound.rounding + bound.coefficients)
    assert 0 < bound.coefficients < 1e-3


def test_rounding_to_nearest_halves_the_bound() -> None:
    """Half an LSB instead of one at each rounding."""
    cut, nearest = (prove(fixed_pi(rounding), plant()).closed_loop for rounding in Rounding)
    assert cut is not None and nearest is not None
    assert nearest.rounding == pytest.approx(cut.rounding / 2, rel=1e-9)
    assert nearest.coefficients == pytest.approx(cut.coefficients)


def test_the_loop_never_exceeds_the_bound() -> None:
    """Fixed-point and real-number controller on the same plant: 40,000 steps of set-points."""
    for rounding in Rounding:
        fixed = fixed_pi(rounding)
        bound = prove(fixed, plant()).closed_loop
        assert bound is not None
        error = np.abs(_loop_errors(fixed, 20_000))
        assert 0.02 * bound.total < error.max() <= bound.total


def _loop_errors(fixed: FixedPoint, steps: int) -> np.ndarray:
    """Observed differences to the loop with the gains wanted, in V."""
    system = plant().system
    pole, drive = float(system.A[0, 0]), float(system.B[0, 0] * system.C[0, 0])
    wanted = {slot.name: slot.initial for slot in fixed.source.parameters}
    execution = Execution(fixed.program)
    random = np.random.default_rng(4)
    levels = np.repeat(random.integers(-8192, 8192, steps // 100), 100)
    speeds, integral, differences = [0.0, 0.0], 0.0, []
    for level in levels:
        given = {"Input_Voltage": int(level), "Speed": round(speeds[0] * 1024)}
        exact_speed = speeds[1] + (given["Speed"] / 1024 - speeds[0])
        volts = execution.step(given)["correctedvoltage"] / 2048
        error = level / 2048 - wanted["Scale"] * exact_speed
        command = wanted["Kp"] * error + integral
        integral += wanted["Ki_Ts"] * error
        speeds = [pole * speeds[0] + drive * volts, pole * speeds[1] + drive * command]
        differences.append((speeds[0] - speeds[1]) * LOOP.feedback_gain)
    return np.array(differences)


def test_one_step_stays_within_its_bound() -> None:
    """From random states in range, against the real gains; at most 0.8775 mV (1.80 LSB)."""
    fixed = fixed_pi()
    bound = prove(fixed).one_step["correctedvoltage"]
    assert 0.87e-3 < bound <= 0.8775e-3
    real = {slot.name: slot.initial for slot in fixed.source.parameters}
    random, worst = np.random.default_rng(9), 0.0
    execution = Execution(fixed.program)
    for _ in range(3000):
        reference, speed = (int(v) for v in random.integers(-20480, 20481, 2))
        execution.reset()
        got = execution.step({"Input_Voltage": reference, "Speed": speed})["correctedvoltage"]
        error = reference / 2048 - real["Scale"] * speed / 1024
        wanted = float(np.clip(real["Kp"] * error, -9.0, 9.0))
        worst = max(worst, abs(got / 2048 - wanted))
    assert 0.5 * bound < worst <= bound


@pytest.mark.skipif(shutil.which("gappa") is None, reason="the prover gappa is not installed")
@pytest.mark.parametrize("name", CASES)
def test_gappa_proves_the_one_step_bound(name: str) -> None:
    """The generated script is accepted; with half the bound it is not."""
    fixed = CASES[name]
    bounds = prove(fixed).one_step
    check_with_gappa(gappa_script(fixed, bounds))
    with pytest.raises(DesignError, match="cannot prove"):
        check_with_gappa(gappa_script(fixed, {k: 0.5 * v for k, v in bounds.items()}))


def test_inputs_of_different_fractions_are_added_without_a_product() -> None:
    """To more fractional bits Ada converts, and in real numbers nothing happens."""
    diagram = Diagram("scales", 0.01)
    total = diagram.add(Sum("Total", signs="++"))
    for port, name in enumerate(("Fine", "Coarse")):
        diagram.connect(diagram.add(Inport(name)), total, port)
    diagram.connect(total, diagram.add(Outport("Out")))
    fixed = to_fixed_point(diagram, FixedPointOptions({"Fine": 1.0, "Coarse": 10.0}))
    converted = "Total := Sfix32_En14 (Inputs.Fine) + Sfix32_En14 (Inputs.Coarse);"
    assert converted in generate_ada(fixed).files["scales.adb"]
    assert "Total_f = (Fine_g + Coarse_g);" in gappa_script(fixed, prove(fixed).one_step)


def gain_before(last: Block) -> FixedPoint:
    """A gain, then the block."""
    diagram = Diagram("chain", 0.01)
    blocks = Inport("In"), Gain("First", gain=0.75), last, Outport("Out")
    diagram.connect_chain(*map(diagram.add, blocks))
    return to_fixed_point(diagram, FixedPointOptions({"In": 4.0}))


def test_without_a_bound_there_is_no_script_for_gappa(tmp_path: Path) -> None:
    """A relay decides: the script of an earlier design goes, and the proof says why."""
    generate_fixed_c(gain_before(Gain("Last", gain=0.5))).write(tmp_path)
    assert (tmp_path / "chain.gappa").is_file()
    fixed = gain_before(Relay("Last", on_above=0.5, off_below=-0.5))
    generate_fixed_c(fixed).write(tmp_path)
    assert not (tmp_path / "chain.gappa").exists()
    assert "there is no goal for Gappa" in (tmp_path / "chain_proof.txt").read_text()
    with pytest.raises(DesignError, match="'chain': no outport has a bound"):
        gappa_script(fixed, {})


def test_the_proof_lies_beside_the_c(tmp_path: Path) -> None:
    """JSON and text name formats, gains, the digest of the C, and the bound."""
    code = generate_fixed_c(fixed_pi(), plant())
    code.write(tmp_path)
    record = json.loads((tmp_path / "functional_proof.json").read_text())
    assert record["input_digest"] == code.digest
    loop = record["closed_loop"]
    assert sum(row["share"] for row in loop["sources"]) == pytest.approx(1.051e-3, abs=5e-7)
    assert loop["bound"] == pytest.approx(1.648e-3, abs=1e-6)
    assert record["all_time_error"].startswith("not stated: the loop has no bounded error")
    assert {row["name"]: row["raw"] for row in record["gains"]}["Kp"] == 11832
    text = (tmp_path / "functional_proof.txt").read_text()
    assert "<= 0.00164836 V" in text
    assert "sfix32_En26" in text


def test_the_anti_windup_path_is_exact_without_saturation() -> None:
    """What the limit cuts off is 0 then, so its coarse rounding has no share in the bound."""
    fixed = anti_windup(IntegrationMethod.FORWARD_EULER, Rounding.NEAREST)
    system = plant().system * LOOP.feedback_gain
    bound = prove(fixed, type(plant())(system, ("Real_Voltage",), 1.0, "V")).closed_loop
    assert bound is not None
    shares = {
        source.block: (source.active, share)
        for source, share in zip(bound.sources, bound.shares, strict=True)
    }
    assert shares["Tracking"] == (False, 0.0)
    assert shares["correctedvoltage"][0]
    assert 0 < bound.rounding < 1e-3


def test_a_state_without_end_needs_a_range() -> None:
    """The message names the integrator and says that it will saturate."""
    with pytest.raises(DesignError, match="'Integral' has no bound of its own; give its range"):
        to_fixed_point(paper_pi(), FixedPointOptions({"Input_Voltage": 10.0, "Speed": 20.0}))


def test_an_inport_without_a_range_is_named() -> None:
    """Nothing is guessed."""
    with pytest.raises(DesignError, match="Inport 'Speed' needs a range"):
        to_fixed_point(paper_pi(), FixedPointOptions({"Input_Voltage": 10.0, "Integral": 9.0}))


def test_a_range_for_nothing_is_refused() -> None:
    """A misspelt block does not pass in silence."""
    ranges = {"Input_Voltage": 10.0, "Speed": 20.0, "Integrall": 9.0}
    with pytest.raises(DesignError, match="'Integrall', which is not an Inport"):
        to_fixed_point(paper_pi(), FixedPointOptions(ranges))


def test_an_unstable_loop_has_no_bound() -> None:
    """A plant with the wrong sign."""
    wrong = plant()
    with pytest.raises(DesignError, match="needs a stable loop"):
        prove(fixed_pi(), type(wrong)(-1 * wrong.system, wrong.measured))


def test_a_locked_format_is_kept() -> None:
    """The output with 8 fractional bits only."""
    ranges = {"Input_Voltage": 10.0, "Speed": 20.0, "Integral": 9.0}
    options = FixedPointOptions(ranges, {"correctedvoltage": FixedFormat(16, 8)})
    fixed = to_fixed_point(paper_pi(), options)
    assert str(fixed.format(Kind.OUTPUT, "correctedvoltage")) == "sfix16_En8"


def test_the_c_for_the_brick_is_small_and_calls_nothing(tmp_path: Path) -> None:
    """The step with tunable gains is at most 160 bytes of ARM code, without a library routine."""
    for rounding in Rounding:
        generate_c(fixed_pi(rounding).program).write(tmp_path)
        target = tmp_path / "functional.o"
        source = tmp_path / "functional.c"
        run("arm-none-eabi-gcc", "-O2", *ARM, *WARNINGS, "-c", source, "-o", target)
        needed = run("arm-none-eabi-nm", "-u", target).split()
        assert set(needed) <= {"U", "functional_U", "functional_Y"}
        rows = [line.split() for line in run("arm-none-eabi-nm", "-S", target).splitlines()]
        sizes = {row[3]: int(row[1], 16) for row in rows if len(row) == 4}
        assert 80 < sizes["functional_step_instance"] <= 160
