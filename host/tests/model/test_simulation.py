# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Closed loops and plants in continuous time, against closed forms and python-control."""

from __future__ import annotations

import ctypes
import math
from pathlib import Path

import control
import numpy as np
import pytest
from scipy import linalg
from verification.support.codegen.brick_cycles import image_of_checks, step_costs
from verification.support.codegen.c_build import WORD_FLAGS, host_library

from ravenbrick.codegen import check_program, generate_c
from ravenbrick.codegen.vectors import StepVectors
from ravenbrick.control import DiscretePi, pi_diagram
from ravenbrick.errors import DesignError
from ravenbrick.model import (
    NXT_MOTOR,
    NXTWAY_GS,
    Block,
    Constant,
    ContinuousStateSpace,
    CustomDerivatives,
    DataType,
    Diagram,
    DryFriction,
    EncoderCount,
    FixedPointOptions,
    Gain,
    Inport,
    IntegrationMethod,
    Integrator,
    Interval,
    Outport,
    Recording,
    Saturation,
    Simulation,
    Solver,
    Sum,
    TimeFunction,
    UnitDelay,
    continuous_transfer_function,
    linear_plant,
    motor_plant,
    to_fixed_point,
    vehicle_plant,
    white_noise,
)

REAL = DataType.REAL64
PI = pi_diagram(DiscretePi(0.314445, 0.032221, 0.004, IntegrationMethod.FORWARD_EULER), 9.0, 0.037)


def chain(*blocks: Block, name: str = "plant") -> Diagram:
    """Blocks between the ports u and y."""
    diagram = Diagram(name, 0.001)
    parts = [diagram.add(block) for block in blocks]
    source, sink = diagram.add(Inport("u", REAL)), diagram.add(Outport("y", REAL))
    diagram.connect_chain(source, *parts, sink)
    return diagram


def motor_loop(stop: float = 0.6) -> Recording:
    """The vehicle's PI and a motor, with the speed as volts; 3 V are wanted."""
    plant = linear_plant("motor", control.tf([1.0], [0.037, 1.0]), ["V"], ["Real_Voltage"])
    return Simulation(PI, plant, lines={"V": "correctedvoltage"}).run(stop, {"Input_Voltage": 3.0})


def test_a_motor_follows_its_exponential() -> None:
    """Within 1e-6 rad/s of K u (1 - exp(-t / tau)), angle and count with it."""
    found = Simulation(None, motor_plant("motor", NXT_MOTOR)).run(0.5, {"voltage": 5.0})
    time, tau = found["speed"].times, NXT_MOTOR.time_constant
    speed = 5 * NXT_MOTOR.gain * (1 - np.exp(-time / tau))
    assert found["speed"].values == pytest.approx(speed, abs=1e-6)
    angle = 5 * NXT_MOTOR.gain * (time - tau * (1 - np.exp(-time / tau)))
    assert found["angle"].values == pytest.approx(angle, abs=1e-6)
    assert found["encoder_count"].values[-1] == math.floor(math.degrees(angle[-1]) + 0.5)


def test_edges_of_an_encoder_are_located_in_time() -> None:
    """At 2 rad/s edge n comes at (n - 0.5) degrees, to a nanosecond."""
    ramp = chain(Integrator("Angle"), EncoderCount("Encoder"))
    found = Simulation(None, ramp).run(0.5, {"u": 2.0})
    edges = [time for time, path in found.events if path == "plant/Encoder"]
    wanted = [math.radians(n + 0.5) / 2.0 for n in range(len(edges))]
    assert len(edges) == 57
    assert edges == pytest.approx(wanted, abs=1e-9)


def test_a_limited_integrator_leaves_its_limit_at_once() -> None:
    """It reaches 1 after 1 s, stays, and falls from there when the input turns at 2 s."""
    limited = chain(Integrator("Held", lower=-1.0, upper=1.0))
    found = Simulation(None, limited).run(3.5, {"u": lambda t: 1.0 if t < 2.0 else -1.0})
    assert [found["y"].at(time) for time in (0.5, 1.5, 2.0, 2.5, 3.5)] == pytest.approx(
        [0.5, 1.0, 1.0, 0.5, -0.5], abs=1e-6
    )
    with pytest.raises(DesignError, match="initial value 2 is outside of its limits -1 and 1"):
        Integrator("Held", initial=2.0, lower=-1.0, upper=1.0)


def test_dry_friction_stops_a_mass_where_the_closed_form_says_and_holds_it() -> None:
    """From 2 m/s with 0.5 N on 1 kg it stands after 4 s and 4 m; less than 0.8 N moves nothing."""
    d = Diagram("plant", 0.001)
    push, friction = d.add(Inport("u", REAL)), d.add(DryFriction("F", static=0.8, kinetic=0.5))
    net = d.add(Sum("Net", REAL, signs="+-"))
    speed, place = d.add(Integrator("Speed", initial=2.0)), d.add(Integrator("Place"))
    d.connect(push, net)
    d.connect_chain(net, speed, place, d.add(Outport("y", REAL)))
    d.connect(push, friction, 0)
    d.connect(speed, friction, 1)
    d.connect(friction, net, 1)
    found = Simulation(None, d).run(8.0, {"u": lambda t: 0.7 if t > 5.0 else 0.0})
    assert found["y"].values[-1] == pytest.approx(4.0, abs=1e-5)
    stops = [time for time, path in found.events if path == "plant/F"]
    assert stops[0] == pytest.approx(4.0, abs=1e-5)
    moved = Simulation(None, d).run(8.0, {"u": lambda t: 0.9 if t > 5.0 else 0.0})
    assert moved["Speed"].values[-1] == pytest.approx(0.4 * 3.0, abs=1e-2)


@pytest.mark.parametrize("method", ["LSODA", "RK45", "DOP853", "Radau"])
def test_the_sampled_loop_is_that_of_the_exact_discretisation(method: str) -> None:
    """At the samples, within 1e-5 V of a recursion in double precision."""
    plant = linear_plant("motor", control.tf([1.0], [0.037, 1.0]), ["V"], ["Real_Voltage"])
    solver = Solver(method, relative=1e-8, absolute=1e-10)
    loop = Simulation(PI, plant, lines={"V": "correctedvoltage"}, solver=solver)
    found = loop.run(0.2, {"Input_Voltage": 3.0})["functional/Real_Voltage"].values
    decay, speed, integral, wanted = math.exp(-0.004 / 0.037), 0.0, 0.0, []
    for _ in range(len(found)):
        wanted.append(speed)
        error = 3.0 - speed
        volts = 0.314445 * error + integral
        integral += 0.032221 * error
        speed = decay * speed + (1 - decay) * volts
    assert found == pytest.approx(wanted, abs=1e-5)


def recorded(found: Recording) -> StepVectors:
    """What the controller took and gave in a simulation."""
    names = ("Input_Voltage", "Real_Voltage")
    inputs = np.array([found[f"functional/{name}"].values for name in names], np.float32).T
    outputs = np.array([found["functional/correctedvoltage"].values], np.float32).T
    return StepVectors("functional", inputs, outputs)


def test_the_controller_in_a_loop_has_the_bits_of_its_c_on_the_brick(tmp_path: Path) -> None:
    """The C, given the 151 inputs that the simulation recorded, gives its outputs, bit for bit."""
    generate_c(PI).write(tmp_path)
    (tmp_path / "check.c").write_text(check_program(recorded(motor_loop())))
    ports = "ExternalInputs_functional functional_U;\nExternalOutputs_functional functional_Y;\n"
    (tmp_path / "ports.c").write_text(f'#include "functional.h"\n{ports}')
    sources = ["functional.c", "check.c", "ports.c"]
    library = host_library(tmp_path, *sources)
    library.functional_check()
    assert ctypes.c_uint32.in_dll(library, "functional_check_steps").value == 151
    assert ctypes.c_uint32.in_dll(library, "functional_check_failures").value == 0
    image = image_of_checks(tmp_path, ["functional"], sources, (), WORD_FLAGS)
    _, brick = step_costs(image, {"functional": "functional_step_instance"})
    assert brick.read_int("functional_check_steps", "u32") == 151
    assert brick.read_int("functional_check_failures", "u32") == 0


def test_a_fixed_point_controller_closes_the_same_loop() -> None:
    """Its signals are in units, within a count of the loop in floating point."""
    ranges = {"Input_Voltage": Interval.around_zero(12), "Real_Voltage": Interval.around_zero(12)}
    ranges["Integral"] = Interval.around_zero(12)
    fixed = to_fixed_point(PI, FixedPointOptions(ranges))
    plant = linear_plant("motor", control.tf([1.0], [0.037, 1.0]), ["V"], ["Real_Voltage"])
    loop = Simulation(fixed.program, plant, lines={"V": "correctedvoltage"})
    found = loop.run(0.6, {"Input_Voltage": 3.0})
    wanted = motor_loop()["motor/Real_Voltage"].at(0.6)
    assert found["motor/Real_Voltage"].at(0.6) == pytest.approx(wanted, abs=0.01)


def test_a_balancer_by_state_feedback_decays_like_the_matrix_exponential() -> None:
    """python-control's NXTway-GS with gains of an LQR, both parts continuous."""
    system = NXTWAY_GS.state_space()
    gain, _, _ = control.lqr(system, np.eye(4), np.eye(2))
    start = (0.0, 0.1, 0.0, 0.0)
    closed = control.ss(system.A - system.B @ gain, np.zeros((4, 1)), np.eye(4), np.zeros((4, 1)))
    plant = linear_plant(
        "balancer", closed, ["push"], ["angle", "pitch", "dangle", "dpitch"], start
    )
    found = Simulation(None, plant).run(0.5)
    wanted = linalg.expm(closed.A * 0.5) @ np.array(start)
    ends = [found[name].values[-1] for name in ("angle", "pitch", "dangle", "dpitch")]
    assert ends == pytest.approx(wanted, abs=1e-7)


def test_custom_derivatives_swing_like_a_pendulum() -> None:
    """From 90 degrees the period is 1.18034 times that of small swings, 4 K(1/2) / w."""
    pendulum = CustomDerivatives(
        "Pendulum", derivatives=lambda x, u: (x[1], -math.sin(x[0]) + u[0]),
        outputs_of=lambda x, u: (x[0],), initial=(math.pi / 2, 0.0),
    )  # fmt: skip
    found = Simulation(None, chain(pendulum)).run(8.0)["y"]
    crossing = np.flatnonzero((found.values[:-1] > 0) & (found.values[1:] <= 0))[0]
    quarter = np.interp(0.0, found.values[crossing : crossing + 2][::-1],
                        found.times[crossing : crossing + 2][::-1])  # fmt: skip
    assert 4 * quarter == pytest.approx(7.4163, abs=1e-3)
    wrong = CustomDerivatives("Wrong", derivatives=lambda x, u: (0.0, 0.0))
    with pytest.raises(DesignError, match="block 'Wrong': 2 values instead of 1"):
        Simulation(None, chain(wrong)).run(1.0)


def test_the_vehicle_drives_a_circle() -> None:
    """With constant voltages the radius is track / 2 (r + l) / (r - l) of the speeds."""
    plant = vehicle_plant("vehicle", NXT_MOTOR, wheel_radius=0.028, track=0.11, mass=0.001)
    found = Simulation(None, plant).run(1.5, {"left_voltage": 4.0, "right_voltage": 5.0})
    begin, end = (np.array([found[n].at(t) for n in ("x", "y")]) for t in (1.0, 1.5))
    turn = found["heading"].at(1.5) - found["heading"].at(1.0)
    radius = np.linalg.norm(end - begin) / (2 * math.sin(turn / 2))
    assert radius == pytest.approx(0.055 * 9.0 / 1.0, rel=1e-3)


def test_latency_shifts_what_reaches_the_plant() -> None:
    """A ramp through a sampler that acts 0.4 ms late is held from 0.4 ms after each sample."""
    sampler = Diagram("sampler", 0.01)
    sampler.connect_chain(sampler.add(Inport("clock")), sampler.add(Outport("u")))
    plant = chain(Gain("Same", REAL))
    time = TimeFunction("Time")
    plant.connect_chain(plant.add(time), plant.add(Outport("clock", REAL)))
    found = Simulation(sampler, plant, latency=0.0004).run(0.05)["y"]
    assert [found.at(t) for t in (0.0203, 0.0205, 0.0303)] == pytest.approx([0.01, 0.02, 0.02])
    with pytest.raises(DesignError, match="less than a sample time"):
        Simulation(sampler, plant, latency=0.01)


def test_noise_has_a_seed() -> None:
    """The same seed gives the same run, another one another; the deviation is as stated."""

    def run(seed: int) -> np.ndarray:
        plant = Diagram("plant", 0.001)
        noise = white_noise("Noise", 0.5, 0.001, seed)
        plant.connect_chain(plant.add(noise), plant.add(Outport("y", REAL)))
        return Simulation(None, plant).run(2.0)["y"].values

    assert np.array_equal(run(1), run(1))
    assert not np.array_equal(run(1), run(2))
    assert np.std(run(1)) == pytest.approx(0.5, rel=0.05)


def test_two_controllers_run_at_their_own_rates() -> None:
    """A slow one sets what a fast one follows; each has a sample per period."""
    slow, fast = Diagram("slow", 0.01), Diagram("fast", 0.002)
    count = slow.add(Sum("Count", signs="++"))
    slow.connect(slow.add(Constant("One", value=1.0)), count)
    slow.connect_chain(count, slow.add(UnitDelay("Last")))
    slow.connect(slow.blocks[-1], count, 1)
    slow.connect(count, slow.add(Outport("wanted")))
    fast.connect_chain(fast.add(Inport("wanted")), fast.add(Outport("u")))
    found = Simulation([slow, fast], chain(Integrator("I"))).run(0.1)
    assert len(found["slow/wanted"].times) == 11
    assert len(found["fast/u"].times) == 51
    assert found["y"].values[-1] == pytest.approx(0.01 * sum(range(1, 11)), abs=1e-9)


def test_a_saturation_in_the_plant_is_an_event() -> None:
    """sin t passes 0.5 at pi / 6 and 5 pi / 6; a lag of 1 s passes it at ln 2."""
    limit = Saturation("L", REAL, limit=0.5)
    found = Simulation(None, chain(limit)).run(3.0, {"u": math.sin})
    times = [time for time, _ in found.events]
    assert times == pytest.approx([math.pi / 6, 5 * math.pi / 6], abs=1e-8)
    lag = continuous_transfer_function("Lag", [1.0], [1.0, 1.0])
    found = Simulation(None, chain(lag, limit)).run(2.0, {"u": 1.0})
    assert [time for time, _ in found.events] == pytest.approx([math.log(2.0)], abs=1e-8)


def test_every_signal_is_found_by_its_path_and_plotted() -> None:
    """Full paths, unambiguous endings, patterns; an error lists what there is."""
    found = motor_loop(0.1)
    assert {"functional/Error", "functional/Saturated", "motor/System"} <= set(found)
    assert len(found.plot("functional/*", "motor/Real_Voltage").axes) == 2
    with pytest.raises(DesignError, match="no signal is called 'nothing'; there are: "):
        found["nothing"]


@pytest.mark.parametrize(
    ("inputs", "sentence"),
    [({"Speed": 1.0}, "no input 'Speed'; there are: Input_Voltage"), ({}, "must be > 0 s")],
)
def test_wrong_inputs_are_named(inputs: dict[str, float], sentence: str) -> None:
    """What the simulation has instead is listed."""
    plant = linear_plant("motor", control.tf([1.0], [0.037, 1.0]), ["V"], ["Real_Voltage"])
    loop = Simulation(PI, plant, lines={"V": "correctedvoltage"})
    with pytest.raises(DesignError, match=sentence):
        loop.run(0.1 if inputs else 0.0, inputs)


def test_a_continuous_block_becomes_no_c() -> None:
    """The error names it and says what to do."""
    with pytest.raises(DesignError, match="block 'I' of diagram 'plant' is continuous"):
        generate_c(chain(Integrator("I")))
    sampled = control.ss([[0.5]], [[1.0]], [[1.0]], [[0.0]], 0.01)
    with pytest.raises(ValueError, match="block 'S': the system is sampled"):
        ContinuousStateSpace.of("S", sampled)
