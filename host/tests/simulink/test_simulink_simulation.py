# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Models in continuous time, against python-control and exact solutions."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import control
import numpy as np
import pytest
from scipy.integrate import solve_ivp
from verification.support.codegen.simulink_files import block, line, single_file

from ravenbrick.errors import DesignError
from ravenbrick.simulink import ModelSource, import_model, import_simulink
from ravenbrick.simulink.numbers import Workspace
from ravenbrick.simulink.simulate import Simulation, simulate

MODELS = Path(__file__).resolve().parents[3] / "examples" / "paper" / "models"
POSITION = Path(os.environ.get("RAVENBRICK_SLX_MODELS", "")) / "snehadubey9066/MBD_week2_ques4"
PLANT = block("TransferFcn", "Plant", 3, Numerator="[2]", Denominator="[0.05 1]")


def run(path: Path, root: str, stop: float, sample_time: float = 0.0) -> Simulation:
    """A model of these blocks, simulated."""
    return simulate(ModelSource(single_file(path, root), sample_time, Workspace({}), ()), stop)


def values(found: Simulation, name: str) -> np.ndarray:
    """The values of a signal."""
    return next(signal.values for signal in found.signals if signal.name == name)


def chain(*blocks: str, feedback: bool = False) -> str:
    """A step at 0, blocks with the numbers 2, 3, ... in a row, and a scope at the end."""
    last = len(blocks) + 1
    root = block("Step", "r", 1, Time="0") + "".join(blocks) + block("Scope", "S", 99)
    root += "".join(line(f"{n}#out:1", f"{n + 1}#in:1") for n in range(1, last))
    back = ("2#in:2",) if feedback else ()
    return root + line(f"{last}#out:1", "99#in:1", *back)


def test_figure_4_is_the_closed_loop_of_python_control() -> None:
    """All instants within 1e-8 of the step response."""
    source = ModelSource(MODELS / "figure4.slx", 0.0, Workspace({}), ())
    found = simulate(source)
    open_loop = control.tf([0.361, 9.76], [1, 0]) * control.tf([2.029], [0.037, 1])
    closed = control.feedback(open_loop * (57.2958 / 116), 1)
    _, expected = control.step_response(closed, found.times)
    assert len(found.times) == 1001
    assert values(found, "voltage") == pytest.approx(expected, abs=1e-8)


def test_a_sampled_controller_drives_a_continuous_plant(tmp_path: Path) -> None:
    """At the samples it is the loop with the plant's exact discretisation."""
    pid = block("Reference", "PID", 3, SourceBlock="simulink/Continuous/PID Controller",
                TimeDomain="Discrete-time", SampleTime="0.01", Controller="PI", P="0.2", I="4",
                IntegratorMethod="Forward Euler")  # fmt: skip
    plant = PLANT.replace('SID="3"', 'SID="4"')
    root = chain(block("Sum", "E", 2, Inputs="+-"), pid, plant, feedback=True)
    found = run(tmp_path / "m.slx", root, 0.5)
    assert found.sample_time == 0.01
    controller = control.tf([0.2, 4 * 0.01 - 0.2], [1, -1], 0.01)
    exact = control.sample_system(control.tf([2], [0.05, 1]), 0.01, "zoh")
    times, expected = control.step_response(control.feedback(controller * exact, 1), 0.5)
    at_samples = [np.argmin(np.abs(found.times - t)) for t in times]
    assert values(found, "Plant")[at_samples] == pytest.approx(expected, abs=1e-8)


def test_a_zero_order_hold_holds_between_its_samples(tmp_path: Path) -> None:
    """A sine behind it is a staircase."""
    root = block("Sin", "r", 1, Frequency="10") + block("ZeroOrderHold", "H", 2, SampleTime="0.1")
    root += block("Scope", "S", 3, Ports="[2]")
    root += line("1#out:1", "2#in:1", "3#in:1") + line("2#out:1", "3#in:2")
    found = run(tmp_path / "m.slx", root, 0.95)
    sample = np.floor(found.times / 0.1 + 1e-6)
    jumps = np.isclose(found.times / 0.1, np.round(found.times / 0.1), atol=1e-6)
    held = np.sin(10 * 0.1 * sample)
    assert values(found, "H")[~jumps] == pytest.approx(held[~jumps])
    assert values(found, "r") == pytest.approx(np.sin(10 * found.times), abs=1e-6)


CASES = {
    "integrator with limits": (
        block("Integrator", "B", 2, LimitOutput="on", UpperSaturationLimit="0.4",
              LowerSaturationLimit="-1"),
        lambda t: np.minimum(t, 0.4),
    ),
    "state space": (
        block("StateSpace", "B", 2, A="[0 1; -100 -4]", B="[0; 100]", C="[1 0]", D="0"),
        lambda t: control.step_response(control.tf([100], [1, 4, 100]), t)[1],
    ),
    "transfer function with feedthrough": (
        block("TransferFcn", "B", 2, Numerator="[1 1]", Denominator="[0.1 1]"),
        lambda t: 1 + 9 * np.exp(-10 * t),
    ),
    "saturation": (block("Saturate", "B", 2, UpperLimit="0.25", LowerLimit="-1"),
                   lambda t: np.full_like(t, 0.25)),
    "PID with a filtered derivative": (
        block("Reference", "B", 2, SourceBlock="simulink/Continuous/PID Controller",
              P="2", I="3", D="0.1", N="50"),
        lambda t: 2 + 3 * t + 0.1 * 50 * np.exp(-50 * t),
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", CASES)
def test_a_block_answers_a_step_as_it_should(name: str, tmp_path: Path) -> None:
    """From 0 to 1 s."""
    one, expected = CASES[name]
    found = run(tmp_path / "m.slx", chain(one), 1.0)
    assert values(found, "B") == pytest.approx(expected(found.times), abs=2e-6)


def test_anti_windup_shortens_the_way_back(tmp_path: Path) -> None:
    """A continuous PI with clamping at its limits overshoots less than one without."""
    overshoots = []
    for mode in ("none", "clamping"):
        pid = block("Reference", "PID", 3, SourceBlock="simulink/Continuous/PID Controller",
                    Controller="PI", P="1", I="30", LimitOutput="on", UpperSaturationLimit="0.6",
                    LowerSaturationLimit="-0.6", AntiWindupMode=mode)  # fmt: skip
        plant = PLANT.replace('SID="3"', 'SID="4"')
        root = chain(block("Sum", "E", 2, Inputs="+-"), pid, plant, feedback=True)
        found = run(tmp_path / "m.slx", root, 2.0)
        figures = next(signal.figures for signal in found.signals)
        assert figures is not None
        overshoots.append(figures.overshoot)
    assert overshoots[1] < 0.5 * overshoots[0]


def test_gains_of_figure_5_stay_tunable() -> None:
    """Workspace variables are fields; the limits come from one of them, the battery."""
    program = import_simulink(MODELS / "figure5.slx", 0.004).lower()
    assert {slot.name: slot.initial for slot in program.parameters} == {
        "Kp": 0.361, "Ki": 9.76, "battery": 8.0,
    }  # fmt: skip


@pytest.mark.skipif(not POSITION.is_dir(), reason="RAVENBRICK_SLX_MODELS has no such model")
def test_a_public_motor_model_meets_the_criteria_that_it_publishes() -> None:
    """Position of a DC motor: settling below 40 ms, overshoot below 16 %."""
    motor = {"J": 3.2284e-6, "b": 3.5077e-6, "K": 0.0274, "Ke": 0.0274854, "R": 4.0, "L": 2.75e-6}
    gains = {"Kp": 21.0, "Ki": 505.0, "Kd": 0.15, "N": 1210.0}
    path = POSITION / "W2ques4_system.slx"
    found = simulate(ModelSource(path, 0.0, Workspace({**motor, **gains}), ()), 0.07)
    figures = found.signals[0].figures
    assert figures is not None and figures.settling_time is not None
    assert figures.settling_time < 0.04 and figures.overshoot < 0.16


def sources(kind: str, **parameters: Any) -> str:
    """A source and a scope."""
    return block(kind, "W", 1, **parameters) + block("Scope", "S", 2) + line("1#out:1", "2#in:1")


@pytest.mark.parametrize(
    ("form", "wave"),
    [
        ("sine", lambda turns: np.sin(2 * np.pi * turns)),
        ("square", lambda turns: np.where(turns % 1 < 0.5, 1.0, -1.0)),
        ("sawtooth", lambda turns: 1 - 2 * (turns % 1)),
    ],
)
def test_a_signal_generator_repeats_its_wave(form: str, wave: Any, tmp_path: Path) -> None:
    """Between the jumps, where the value before and after differ."""
    root = sources("SignalGenerator", WaveForm=form, Amplitude="3", Frequency="2")
    found = run(tmp_path / "m.slx", root, 2.0)
    turns = 2 * found.times
    smooth = np.abs(turns * 2 - np.round(turns * 2)) > 1e-6
    assert values(found, "W")[smooth] == pytest.approx(3 * wave(turns[smooth]), abs=1e-8)


def test_a_repeating_sequence_and_a_chirp_follow_the_time(tmp_path: Path) -> None:
    """Lines between corners again and again; a frequency that grows."""
    parts = {"rep_seq_t": "[0 1 2]", "rep_seq_y": "[0 4 0]"}
    link = "simulink/Sources/Repeating Sequence"
    found = run(tmp_path / "m.slx", sources("Reference", SourceBlock=link, **parts), 5.0)
    place = found.times % 2
    assert values(found, "W") == pytest.approx(4 * np.minimum(place, 2 - place), abs=1e-6)
    parts = {"f1": "1", "T": "10", "f2": "3"}
    link = "simulink/Sources/Chirp Signal"
    found = run(tmp_path / "n.slx", sources("Reference", SourceBlock=link, **parts), 5.0)
    turns = (1 + 0.1 * found.times) * found.times
    assert values(found, "W") == pytest.approx(np.sin(2 * np.pi * turns), abs=1e-7)


def test_a_variable_of_the_workspace_is_a_recorded_signal(tmp_path: Path) -> None:
    """Rows of time and value, joined by straight lines."""
    path = single_file(tmp_path / "m.slx", sources("FromWorkspace", VariableName="record"))
    rows = np.array([[0.0, 1.0], [1.0, 3.0], [2.0, -1.0]])
    found = simulate(ModelSource(path, 0.0, Workspace({"record": rows}), ()), 2.0)
    assert values(found, "W") == pytest.approx(np.interp(found.times, *rows.T), abs=1e-8)


def test_a_double_integrator_gives_place_and_speed(tmp_path: Path) -> None:
    """Of a constant acceleration from a place and a speed."""
    root = block("Constant", "a", 1, Value="-9.81")
    root += block("SecondOrderIntegrator", "Fall", 2, ICX="10", ICDXDT="3", Ports="[1, 2]")
    root += block("Outport", "place", 3) + block("Outport", "speed", 4, Port=2)
    root += line("1#out:1", "2#in:1") + line("2#out:1", "3#in:1") + line("2#out:2", "4#in:1")
    found = run(tmp_path / "m.slx", root, 2.0)
    t = found.times
    assert values(found, "place") == pytest.approx(10 + 3 * t - 9.81 * t**2 / 2, abs=1e-8)
    assert values(found, "speed") == pytest.approx(3 - 9.81 * t, abs=1e-8)


def test_the_derivative_of_a_continuous_signal_is_a_fast_filter(tmp_path: Path) -> None:
    """Within the filter's lag, and 0 at the beginning."""
    root = block("SignalGenerator", "w", 1, WaveForm="sine", Amplitude="2", Frequency="3",
                 Units="rad/sec")  # fmt: skip
    root += block("Derivative", "D", 2) + block("Outport", "rate", 3)
    root += line("1#out:1", "2#in:1") + line("2#out:1", "3#in:1")
    found = run(tmp_path / "m.slx", root, 5.0)
    late = found.times > 0.01
    rate = values(found, "rate")
    assert rate[late] == pytest.approx(6 * np.cos(3 * found.times[late]), abs=0.02)
    assert rate[0] == 0.0


def test_derivatives_of_sines_and_of_integrals_are_exact(tmp_path: Path) -> None:
    """The second one of a sine, and the one of an integral, which is what it integrates."""
    root = block("Sin", "w", 1, Amplitude="2", Frequency="3", Bias="1", SampleTime="0")
    root += block("Derivative", "D", 2) + block("Derivative", "E", 3)
    root += block("Integrator", "I", 4) + block("Derivative", "F", 5)
    root += block("Outport", "second", 6, Port=1) + block("Outport", "back", 7, Port=2)
    root += line("1#out:1", "2#in:1", "4#in:1") + line("2#out:1", "3#in:1")
    root += line("3#out:1", "6#in:1") + line("4#out:1", "5#in:1") + line("5#out:1", "7#in:1")
    found = run(tmp_path / "m.slx", root, 5.0)
    wave = np.sin(3 * found.times)
    assert values(found, "second") == pytest.approx(-18 * wave, abs=1e-7)
    assert values(found, "back") == pytest.approx(1 + 2 * wave, abs=1e-7)


SMOOTH = {
    "a product": ("u(1)*u(2)", lambda s, c: c * c - s * s),
    "a quotient": ("u(1)/(2+u(2))", lambda s, c: (2 * c + 1) / (2 + c) ** 2),
    "functions": ("sin(u(1)) - cos(2*u(2))",
                  lambda s, c: np.cos(s) * c - 2 * np.sin(2 * c) * s),
    "a root": ("sqrt(2+u(1))", lambda s, c: c / (2 * np.sqrt(2 + s))),
    "an angle": ("atan2(u(1), 2+u(2))", lambda s, c: (2 * c + 1) / (5 + 4 * c)),
}  # fmt: skip


@pytest.mark.parametrize("name", SMOOTH)
def test_the_derivative_of_a_smooth_formula_is_that_of_calculus(name: str, tmp_path: Path) -> None:
    """Of a sine and a cosine, which are states of an oscillator."""
    text, rate = SMOOTH[name]
    root = block("Integrator", "s", 1) + block("Integrator", "c", 2, InitialCondition="1")
    root += block("Gain", "minus", 3, Gain="-1") + block("Mux", "M", 4, Inputs=2)
    root += block("MATLABFcn", "F", 5, MATLABFcn=text) + block("Derivative", "D", 6)
    root += block("Scope", "S", 7) + line("2#out:1", "1#in:1", "4#in:2")
    root += line("1#out:1", "3#in:1", "4#in:1") + line("3#out:1", "2#in:1")
    root += line("4#out:1", "5#in:1") + line("5#out:1", "6#in:1") + line("6#out:1", "7#in:1")
    found = run(tmp_path / "m.slx", root, 4.0)
    assert found.continuous_states == 2  # no filter
    exact = rate(np.sin(found.times), np.cos(found.times))
    assert values(found, "D") == pytest.approx(exact, abs=1e-6)


def test_a_derivative_that_would_close_a_loop_is_a_filter(tmp_path: Path) -> None:
    """x' = 1 - x' / 2 has x' on both sides; with the filter x' is 2/3."""
    root = block("Constant", "one", 1, Value="1") + block("Sum", "E", 2, Inputs="+-")
    root += block("Integrator", "x", 3) + block("Derivative", "D", 4)
    root += block("Gain", "half", 5, Gain="0.5") + block("Scope", "S", 6)
    root += line("1#out:1", "2#in:1") + line("2#out:1", "3#in:1")
    root += line("3#out:1", "4#in:1", "6#in:1") + line("4#out:1", "5#in:1")
    root += line("5#out:1", "2#in:2")
    found = run(tmp_path / "m.slx", root, 3.0)
    assert values(found, "x")[-1] == pytest.approx(2.0, abs=0.01)


def test_an_interpreted_function_drives_an_integrator(tmp_path: Path) -> None:
    """A pendulum falls as scipy has it; its sine has no folds that a solver has to find."""
    root = block("Integrator", "speed", 1) + block("Integrator", "angle", 2, InitialCondition="1")
    root += block("MATLABFcn", "fall", 3, MATLABFcn="-9.81*sin(u)") + block("Scope", "S", 4)
    root += line("3#out:1", "1#in:1") + line("1#out:1", "2#in:1")
    root += line("2#out:1", "3#in:1", "4#in:1")
    found = run(tmp_path / "m.slx", root, 3.0)
    exact = solve_ivp(lambda t, x: [-9.81 * np.sin(x[1]), x[0]], (0, 3), [0.0, 1.0],
                      t_eval=np.unique(found.times), rtol=1e-11, atol=1e-12)  # fmt: skip
    angle = values(found, "angle")[np.unique(found.times, return_index=True)[1]]
    assert angle == pytest.approx(exact.y[1], abs=1e-7)


def test_a_quotient_by_zero_is_infinite_as_in_simulink(tmp_path: Path) -> None:
    """At the beginning the time is 0."""
    root = block("Clock", "t", 1) + block("Constant", "one", 2, Value="1")
    root += block("Product", "P", 3, Inputs="*/") + block("Scope", "S", 4)
    root += line("2#out:1", "3#in:1") + line("1#out:1", "3#in:2") + line("3#out:1", "4#in:1")
    share = values(run(tmp_path / "m.slx", root, 1.0), "P")
    assert np.isinf(share[0]) and share[-1] == pytest.approx(1.0)


SPACE = {"A": "[0 1; -4 -0.6]", "B": "[0 1; 2 0]", "C": "[1 0; 0 1; 1 1]", "D": "zeros(3, 2)"}
ROWS = {"Numerator": "[0 2 1; 3 0 0]", "Denominator": "[2 1 4]"}


@pytest.mark.parametrize("kind", ["StateSpace", "TransferFcn"])
def test_a_linear_block_has_as_many_outputs_as_rows(kind: str, tmp_path: Path) -> None:
    """In time as python-control has it; as C its states exist once."""
    space = kind == "StateSpace"
    root = block("Step", "r", 1, Time="0", After="[1 2]" if space else "1")
    root += block(kind, "G", 2, **(SPACE if space else ROWS)) + block("Scope", "S", 3)
    root += line("1#out:1", "2#in:1") + line("2#out:1", "3#in:1")
    found = run(tmp_path / "m.slx", root, 4.0)
    system = control.ss([[0, 1], [-4, -0.6]], [[0, 1], [2, 0]], [[1, 0], [0, 1], [1, 1]],
                        np.zeros((3, 2)))  # fmt: skip
    if not space:
        system = control.ss([[-0.5, -2], [1, 0]], [[1], [0]], [[1, 0.5], [-0.75, -3]], [[0], [1.5]])
    times = np.linspace(0, 4, 401)
    given = np.vstack([np.ones(401), 2 * np.ones(401)]) if space else np.ones(401)
    exact = control.forced_response(system, times, given).outputs
    for row, wanted in enumerate(exact, 1):
        name = "G" if row == 1 else f"G ({row})"
        own = np.interp(times[1:], found.times, values(found, name))
        assert own == pytest.approx(wanted[1:], abs=2e-4)
    diagram = import_simulink(tmp_path / "m.slx", 0.01)
    assert sum(len(one.states()) for one in diagram.blocks if one.name == "G") == 2


def test_a_sine_of_an_infinite_number_ends_the_simulation_with_a_reason(tmp_path: Path) -> None:
    """Not with Python's words."""
    root = block("Clock", "t", 1) + block("Scope", "S", 3) + line("1#out:1", "2#in:1")
    root += block("MATLABFcn", "F", 2, MATLABFcn="sin(1/u)") + line("2#out:1", "3#in:1")
    with pytest.raises(DesignError, match="look for a quotient by 0"):
        run(tmp_path / "m.slx", root, 1.0)


@pytest.mark.parametrize(
    ("kind", "parameters", "mean", "deviation"),
    [
        ("UniformRandomNumber", {"Minimum": "-1", "Maximum": "3"}, 1.0, 4 / np.sqrt(12)),
        ("RandomNumber", {"Mean": "2", "Variance": "9"}, 2.0, 3.0),
        ("Reference", {"SourceBlock": "simulink/Sources/Band-Limited White Noise", "Cov": "[0.04]",
                       "Ts": "0.01"}, 0.0, 2.0),
    ],
)  # fmt: skip
def test_random_numbers_have_their_distribution(
    kind: str, parameters: dict[str, str], mean: float, deviation: float, tmp_path: Path
) -> None:
    """Their mean and deviation, no memory, and the same numbers for the same seed."""
    sampled = {} if kind == "Reference" else {"SampleTime": "0.01"}
    text = sources(kind, **parameters, **sampled)
    found = values(run(tmp_path / "m.slx", text, 60.0, 0.01), "W")[::2][:5900]
    assert found.mean() == pytest.approx(mean, abs=0.05 * deviation)
    assert found.std() == pytest.approx(deviation, rel=0.03)
    rest = found - found.mean()
    assert abs(np.mean(rest[1:] * rest[:-1])) < 0.05 * deviation**2
    again = values(run(tmp_path / "n.slx", text, 60.0, 0.01), "W")[::2][:5900]
    assert np.array_equal(found, again)


def test_the_atomic_subsystem_is_the_controller_that_becomes_c(tmp_path: Path) -> None:
    """The continuous plant around it is left out; the whole loop simulates."""
    inner = block("Inport", "e", "3::1") + block("Gain", "K", "3::2", Gain="2")
    inner += block("Outport", "u", "3::3") + line("3::1#out:1", "3::2#in:1")
    inner += line("3::2#out:1", "3::3#in:1")
    root = block("Step", "r", 1, Time="0") + block("Sum", "E", 2, Inputs="+-")
    root += block("SubSystem", "Controller", 3, f"<System>{inner}</System>", TreatAsAtomicUnit="on")
    root += PLANT.replace('SID="3"', 'SID="4"') + block("Scope", "S", 5)
    root += line("1#out:1", "2#in:1") + line("2#out:1", "3#in:1") + line("3#out:1", "4#in:1")
    root += line("4#out:1", "2#in:2", "5#in:1")
    path = single_file(tmp_path / "m.slx", root)
    source = ModelSource(path, 0.01, Workspace({}), ())
    found = import_model(source)
    assert found.subsystem == "Controller"
    assert {type(b).__name__ for b in found.diagram.blocks} == {"Inport", "Gain", "Outport"}
    assert found.continuous == ""
    assert simulate(source, 1.0).continuous_states == 1
    assert "continuous blocks: discrete" in source.imported().continuous
