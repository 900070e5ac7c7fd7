# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""What becomes of Simulink's blocks: vectors, buses, conditions, libraries, tables, types."""

from __future__ import annotations

import ctypes
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy import signal
from scipy.interpolate import RegularGridInterpolator
from verification.support.codegen.c_build import host_library
from verification.support.codegen.simulink_files import block, line, run, single_file

from ravenbrick.codegen import check_program, generate_c, random_vectors
from ravenbrick.errors import DesignError
from ravenbrick.simulink import import_simulink, read_workspace

STEPS = 60


def one_block(kind: str, inputs: int, **parameters: Any) -> str:
    """Inports, the block, and its first output on an outport."""
    text = "".join(block("Inport", f"u{i}", f"i{i}", Port=i) for i in range(1, inputs + 1))
    text += block(kind, "B", "b", Ports=f"[{inputs}, 1]", **parameters) + block("Outport", "y", "y")
    text += "".join(line(f"i{i}#out:1", f"b#in:{i}") for i in range(1, inputs + 1))
    return text + line("b#out:1", "y#in:1")


def given(count: int, low: float = -3.0, high: float = 3.0) -> list[np.ndarray]:
    """Inputs with ties, exact in single precision."""
    random = np.random.default_rng(7)
    return [np.round(random.uniform(low, high, STEPS) * 4) / 4 for _ in range(count)]


def wrapped(value: np.ndarray) -> np.ndarray:
    """To eight bits without sign, as numpy's integers wrap."""
    return np.floor(value).astype(np.int64).astype(np.uint8).astype(float)


def powers(base: Any, exponent: Any) -> Any:
    """As Simulink has it, but 0 where there is no real number."""
    with np.errstate(all="ignore"):
        return np.where((base == 0) & (exponent != 0), 0.0, np.nan_to_num(base**exponent))


CASES: dict[str, tuple[str, int, dict[str, Any], Any]] = {
    "equal": ("RelationalOperator", 2, {"Operator": "=="}, lambda a, b: a == b),
    "unequal": ("RelationalOperator", 2, {"Operator": "~="}, lambda a, b: a != b),
    "and of three": ("Logic", 3, {"Operator": "AND", "Inputs": "3"},
                     lambda a, b, c: (a != 0) & (b != 0) & (c != 0)),
    "xor": ("Logic", 2, {"Operator": "XOR", "Inputs": "2"}, lambda a, b: (a != 0) ^ (b != 0)),
    "switch unless 0": ("Switch", 3, {"Criteria": "u2 ~= 0"},
                        lambda a, b, c: np.where(b != 0, a, c)),
    "switch above": ("Switch", 3, {"Criteria": "u2 > Threshold", "Threshold": "1"},
                     lambda a, b, c: np.where(b > 1, a, c)),
    "sum from minus": ("Sum", 3, {"Inputs": "-+-"}, lambda a, b, c: -a + b - c),
    "quotient": ("Product", 3, {"Inputs": "/*/"}, lambda a, b, c: b / a / c),
    "largest of three": ("MinMax", 3, {"Function": "max", "Inputs": "3"},
                         lambda a, b, c: np.maximum(a, np.maximum(b, c))),
    "floor": ("Rounding", 1, {"Operator": "floor"}, np.floor),
    "fix": ("Rounding", 1, {"Operator": "fix"}, np.fix),
    "modulo": ("Math", 2, {"Operator": "mod"}, lambda a, b: np.where(b == 0, a, np.mod(a, b))),
    "remainder": ("Math", 2, {"Operator": "rem"},
                  lambda a, b: np.where(b == 0, a, np.fmod(a, b))),
    "initial condition": ("InitialCondition", 1, {"Value": "7"},
                          lambda a: np.concatenate([[7.0], a[1:]])),
    "exponential": ("Math", 1, {"Operator": "exp"}, np.exp),
    "logarithm": ("Math", 1, {"Operator": "log"}, lambda a: np.log(np.maximum(a, 1.17549435e-38))),
    "power of ten": ("Math", 1, {"Operator": "10^u"}, lambda a: 10.0**a),
    "power": ("Math", 2, {"Operator": "pow"}, powers),
    "cube and root": ("Fcn", 1, {"Expr": "u^3 + abs(u)^0.5 + exp(u)"},
                      lambda a: a**3 + np.sqrt(np.abs(a)) + np.exp(a)),
    "root": ("Sqrt", 1, {}, lambda a: np.sqrt(np.maximum(a, 0))),
    "sine": ("Trigonometry", 1, {"Operator": "sin"}, np.sin),
    "arc cosine": ("Trigonometry", 1, {"Operator": "acos"},
                   lambda a: np.arccos(np.clip(a, -1, 1))),
    "angle": ("Trigonometry", 2, {"Operator": "atan2"}, lambda a, b: np.arctan2(a + 0.0, b)),
    "formula": ("Fcn", 1, {"Expr": "(2*u(1)^2 - abs(u)) / (1 + u^2)"},
                lambda a: (2 * a**2 - np.abs(a)) / (1 + a**2)),
    "to int8, limited": ("DataTypeConversion", 1, {"OutDataTypeStr": "int8", "RndMeth": "Zero",
                         "SaturateOnIntegerOverflow": "on"},
                         lambda a: np.clip(np.fix(a), -128, 127)),
    "to uint8, wrapped": ("DataTypeConversion", 1, {"OutDataTypeStr": "uint8", "RndMeth": "Floor",
                          "SaturateOnIntegerOverflow": "off"}, wrapped),
    "to fixed point": ("DataTypeConversion", 1, {"OutDataTypeStr": "fixdt(1,16,1)",
                       "RndMeth": "Floor"}, lambda a: np.floor(a * 2) / 2),
    "to boolean": ("DataTypeConversion", 1, {"OutDataTypeStr": "boolean"}, lambda a: a != 0),
    "friction": ("Reference", 1, {"SourceBlock": "simulink/Discontinuities/Coulomb &amp;\n"
                 "Viscous Friction", "offset": "5", "gain": "3"},
                 lambda a: np.sign(a) * (3 * np.abs(a) + 5)),
    "limits with one open": ("Saturate", 1, {"UpperLimit": "inf", "LowerLimit": "-1"},
                             lambda a: np.maximum(a, -1)),
    "choice by number": ("MultiPortSwitch", 4, {"DataPortOrder": "Zero-based contiguous",
                         "Inputs": "3"},
                         lambda n, a, b, c: np.select([n < 0.5, n < 1.5], [a, b], c)),
    "staircase": ("Lookup_n-D", 1, {"BreakpointsForDimension1": "[-1 0 2]", "Table": "[3 0 1]",
                  "InterpMethod": "Flat"},
                  lambda a: np.array([3.0, 0.0, 1.0])[np.searchsorted([0.0, 2.0], a, "right")]),
    "limited integrator": ("DiscreteIntegrator", 1, {"gainval": "10", "LimitOutput": "on",
                           "UpperSaturationLimit": "0.5", "LowerSaturationLimit": "-0.25",
                           "IntegratorMethod": "Integration: Forward Euler"},
                           lambda a: limited_sum(0.1 * a, -0.25, 0.5)),
    "accumulator with reset": ("DiscreteIntegrator", 2, {"ExternalReset": "level",
                               "IntegratorMethod": "Accumulation: Forward Euler",
                               "InitialCondition": "1"}, lambda a, b: reset_sum(a, b != 0, 1.0)),
    "hyperbolic tangent": ("Trigonometry", 1, {"Operator": "tanh"}, np.tanh),
    "sine in time": ("Sin", 0, {"Amplitude": "2", "Frequency": "7", "Phase": "0.5", "Bias": "1"},
                     lambda: 1 + 2 * np.sin(7 * 0.01 * np.arange(40) + 0.5)),
}  # fmt: skip


def limited_sum(steps: np.ndarray, low: float, high: float) -> np.ndarray:
    """A sum that stays within limits; each value without the present step."""
    total, values = 0.0, []
    for step in steps:
        values.append(total)
        total = min(max(total + step, low), high)
    return np.array(values)


def reset_sum(steps: np.ndarray, reset: np.ndarray, start: float) -> np.ndarray:
    """A sum that begins anew while it is reset."""
    total, values = start, []
    for step, anew in zip(steps, reset, strict=True):
        total = start if anew else total
        values.append(total)
        total += step
    return np.array(values)


@pytest.mark.parametrize("name", CASES)
def test_a_block_means_what_it_means_in_simulink(name: str, tmp_path: Path) -> None:
    """Against numpy."""
    kind, ports, parameters, reference = CASES[name]
    path = single_file(tmp_path / "m.slx", one_block(kind, ports, **parameters))
    inputs = given(ports, *((-1.0, 1.0) if name == "arc cosine" else (-3.0, 3.0)))
    with np.errstate(all="ignore"):
        wanted = np.asarray(reference(*inputs), np.float64)
    diagram = import_simulink(path, 0.01)
    assert np.allclose(run(diagram, *inputs), wanted, atol=2e-5, rtol=1e-5, equal_nan=True)


def linked(name: str, inputs: int, **parameters: Any) -> str:
    """A link to Simulink's own library."""
    return one_block("Reference", inputs, SourceBlock=f"simulink/Some/{name}", **parameters)


LINKS: dict[str, tuple[int, dict[str, Any], Any]] = {
    "Compare\nTo Constant": (1, {"relop": "&gt;=", "const": "0.5"}, lambda a: a >= 0.5),
    "Compare To Zero": (1, {"relop": "~="}, lambda a: a != 0),
    "Saturation\nDynamic": (3, {}, lambda high, a, low: np.where(a > high, high,
                            np.where(a < low, low, a))),
    "Detect\nChange": (1, {"vinit": "0"}, lambda a: a != np.concatenate([[0], a[:-1]])),
    "Detect Rise\nPositive": (1, {"vinit": "0"},
                              lambda a: (a > 0) & ~np.concatenate([[False], a[:-1] > 0])),
    "Interval Test": (1, {"uplimit": "1", "lowlimit": "-1"}, lambda a: (a <= 1) & (a >= -1)),
    "Discrete Derivative": (1, {}, lambda a: np.diff(a, prepend=0.0) / 0.01),
    "Ramp": (0, {"slope": "2", "start": "0.1", "InitialOutput": "0.5"},
             lambda: 0.5 + 2 * np.maximum(np.arange(40) * 0.01 - 0.1, 0)),
    "Counter\nLimited": (0, {"uplimit": "4;"}, lambda: np.arange(40) % 5),
    "Integer\nDelay": (1, {"NumDelays": "5"}, lambda a: np.concatenate([np.zeros(5), a[:-5]])),
    "Degrees to\nRadians": (1, {}, np.radians),
    "Slider\nGain": (1, {"gain": "2.5"}, lambda a: 2.5 * a),
    "Bitwise\nOperator": (1, {"logicop": "AND", "BitMask": "bin2dec('10')", "NumInputPorts": "1"},
                          lambda a: np.fix(np.maximum(a, 0)).astype(int) & 2),
    "Repeating\nSequence\nStair": (0, {"OutValues": "[3 1 4]"},
                                   lambda: np.tile([3, 1, 4], 14)[:40]),
    "Discrete PID Controller": (1, {"Controller": "PI", "P": "2", "I": "5",
        "TimeDomain": "Discrete-time"},
        lambda a: 2 * a + signal.lfilter([0, 0.05], [1, -1], a)),
}  # fmt: skip


@pytest.mark.parametrize("name", LINKS)
def test_a_link_to_simulinks_library_is_built(name: str, tmp_path: Path) -> None:
    """The file holds only the link."""
    ports, parameters, reference = LINKS[name]
    path = single_file(tmp_path / "m.slx", linked(name, ports, **parameters))
    inputs = given(ports)
    wanted = np.asarray(reference(*inputs), np.float64)
    assert np.allclose(run(import_simulink(path, 0.01), *inputs), wanted, atol=1e-4)


PID_METHODS = {
    "Forward Euler": ([0, 1], [1, -1]),
    "Backward Euler": ([1, 0], [1, -1]),
    "Trapezoidal": ([0.5, 0.5], [1, -1]),
}


@pytest.mark.parametrize("integrator", PID_METHODS)
@pytest.mark.parametrize("derivative", [*PID_METHODS, "unfiltered"])
def test_a_discrete_pid_integrates_and_differentiates_as_its_dialog_says(
    integrator: str, derivative: str, tmp_path: Path
) -> None:
    """P + I Ts a(z) + D N / (1 + N Ts b(z)), against SciPy."""
    use = {"UseFilter": "off"} if derivative == "unfiltered" else {"FilterMethod": derivative}
    text = linked("Discrete PID Controller", 1, P="2", I="5", D="0.1", N="20",
                  TimeDomain="Discrete-time", IntegratorMethod=integrator, **use)  # fmt: skip
    found = run(import_simulink(single_file(tmp_path / "m.slx", text), 0.01), *(u := given(1)))
    top, bottom = (np.array(part, float) for part in PID_METHODS[integrator])
    wanted = 2 * u[0] + signal.lfilter(5 * 0.01 * top, bottom, u[0])
    if derivative == "unfiltered":
        wanted += signal.lfilter([10, -10], [1, 0], u[0])
    else:
        top, bottom = (np.array(part, float) for part in PID_METHODS[derivative])
        wanted += signal.lfilter(0.1 * 20 * bottom, bottom + 20 * 0.01 * top, u[0])
    assert np.allclose(found, wanted, atol=1e-4)


def test_a_limited_pid_whose_anti_windup_would_be_a_loop_is_refused(tmp_path: Path) -> None:
    """With the method that has none."""
    text = linked("Discrete PID Controller", 1, Controller="PI", TimeDomain="Discrete-time",
                  IntegratorMethod="Trapezoidal", LimitOutput="on", UpperSaturationLimit="1",
                  LowerSaturationLimit="-1", AntiWindupMode="clamping")  # fmt: skip
    with pytest.raises(DesignError) as caught:
        import_simulink(single_file(tmp_path / "m.slx", text), 0.01)
    assert "choose the integrator method Forward Euler" in caught.value.detail


def test_vectors_matrices_and_buses_become_single_signals(tmp_path: Path) -> None:
    """Mux, matrix gain, selector, bus by name, demux: the element-wise result."""
    root = "".join(block("Inport", f"u{i}", i, Port=i) for i in (1, 2, 3))
    root += block("Mux", "All", 4, Inputs="3", Ports="[3, 1]")
    root += block("Gain", "K", 5, Gain="[1 2 3; 0 -1 4]", Multiplication="Matrix(K*u)")
    root += block("BusCreator", "Bus", 6, Inputs="2", Ports="[2, 1]")
    root += block("BusSelector", "Chosen", 7, OutputSignals="product,first", Ports="[1, 2]")
    root += block("Demux", "Parts", 8, Outputs="2", Ports="[1, 2]")
    root += block("Sum", "Add", 9, Inputs="+-+", Ports="[3, 1]") + block("Outport", "y", 10)
    root += "".join(line(f"{i}#out:1", f"4#in:{i}") for i in (2, 3))
    root += line("1#out:1", "4#in:1", "6#in:1", name="first")
    root += line("4#out:1", "5#in:1") + line("5#out:1", "6#in:2", name="product")
    root += line("6#out:1", "7#in:1") + line("7#out:1", "8#in:1") + line("7#out:2", "9#in:3")
    root += line("8#out:1", "9#in:1") + line("8#out:2", "9#in:2") + line("9#out:1", "10#in:1")
    a, b, c = given(3)
    found = run(import_simulink(single_file(tmp_path / "m.slx", root), 0.01), a, b, c)
    assert np.allclose(found, (a + 2 * b + 3 * c) - (-b + 4 * c) + a, atol=1e-5)


def test_a_vector_of_numbers_chooses_element_by_element(tmp_path: Path) -> None:
    """Of a number and of vectors."""
    root = block("Inport", "a", 1, Port=1) + block("Inport", "b", 2, Port=2)
    root += block("Constant", "which", 3, Value="[2, 1, 2]")
    root += block("MultiPortSwitch", "B", 5, Inputs=2, Ports="[3, 1]", DataPortOrder="One-based")
    root += block("Gain", "K", 7, Gain="[1 2 3]") + block("Outport", "y", 6)
    root += line("1#out:1", "7#in:1") + line("3#out:1", "5#in:1") + line("7#out:1", "5#in:2")
    root += line("2#out:1", "5#in:3") + line("5#out:1", "6#in:1")
    a, b = given(2)
    found = run(import_simulink(single_file(tmp_path / "m.slx", root), 0.01), a, b)
    assert np.allclose(found, np.transpose([b, 2 * a, b]))


def branches(reset: str) -> str:
    """If u1 > 0 the integral of u2, else its negative, merged."""
    inner = block("Inport", "in", "x1") + block("ActionPort", "Act", "x2", InitializeStates=reset)
    inner += block("DiscreteIntegrator", "Sum of it", "x3", gainval="K",
                   IntegratorMethod="Accumulation: Backward Euler")  # fmt: skip
    inner += (
        block("Outport", "out", "x4") + line("x1#out:1", "x3#in:1") + line("x3#out:1", "x4#in:1")
    )
    parts = [f"<Mask><MaskParameter Name='K'><Value>{k}</Value></MaskParameter></Mask>"
             f"<System>{inner}</System>" for k in (1, -1)]  # fmt: skip
    root = block("Inport", "u1", 1) + block("Inport", "u2", 2, Port=2)
    root += block("If", "Which", 3, IfExpression="u1 &gt; 0", ShowElse="on")
    root += block("SubSystem", "Up", 4, parts[0]) + block("SubSystem", "Down", 5, parts[1])
    root += block("Merge", "Both", 6, Inputs="2", Ports="[2, 1]") + block("Outport", "y", 7)
    root += line("1#out:1", "3#in:1") + line("2#out:1", "4#in:1", "5#in:1")
    root += line("3#out:1", "4#ifaction") + line("3#out:2", "5#ifaction")
    root += line("4#out:1", "6#in:1") + line("5#out:1", "6#in:2") + line("6#out:1", "7#in:1")
    return root


def branched(a: np.ndarray, b: np.ndarray, *, reset: bool) -> np.ndarray:
    """The same, written down."""
    sums, before, found = {True: 0.0, False: 0.0}, None, []
    for condition, step in zip(a > 0, b, strict=True):
        if reset and condition != before:
            sums[bool(condition)] = 0.0
        sums[bool(condition)] += step if condition else -step
        found.append(sums[bool(condition)])
        before = condition
    return np.array(found)


@pytest.mark.parametrize("kind", ["held", "reset"])
def test_action_subsystems_keep_or_forget_their_states(kind: str, tmp_path: Path) -> None:
    """In simulation, and in C the same bits."""
    path = single_file(tmp_path / f"{kind}.slx", branches(kind))
    diagram = import_simulink(path, 0.01)
    a, b = given(2)
    assert np.allclose(run(diagram, a, b), branched(a, b, reset=kind == "reset"), atol=1e-5)
    generate_c(diagram).write(tmp_path)
    (tmp_path / "check.c").write_text(check_program(random_vectors(diagram, 200, seed=3)))
    ports = f"ExternalInputs_{kind} {kind}_U;\nExternalOutputs_{kind} {kind}_Y;\n"
    (tmp_path / "ports.c").write_text(f'#include "{kind}.h"\n{ports}')
    library = host_library(tmp_path, f"{kind}.c", "check.c", "ports.c")
    getattr(library, f"{kind}_check")()
    assert ctypes.c_uint32.in_dll(library, f"{kind}_check_steps").value == 200
    assert ctypes.c_uint32.in_dll(library, f"{kind}_check_failures").value == 0


def gated(port: str, number: str, **outport: str) -> str:
    """A subsystem with a counter that runs while, or whenever, its control input says so."""
    inner = block(port, "Control", "x1", TriggerType="rising", StatesWhenEnabling="held")
    inner += block("Constant", "One", "x2", Value="1") + block("Sum", "Add", "x3", Ports="[2, 1]")
    inner += block("UnitDelay", "Last", "x4") + block("Outport", "n", "x5", **outport)
    inner += line("x2#out:1", "x3#in:1") + line("x4#out:1", "x3#in:2")
    inner += line("x3#out:1", "x4#in:1", "x5#in:1")
    return block("SubSystem", f"Gate {number}", number, f"<System>{inner}</System>")


def test_enabled_and_triggered_subsystems_run_when_told(tmp_path: Path) -> None:
    """A count of steps with a positive input, one of its rises, and an output put back."""
    root = block("Inport", "u", 1)
    root += gated("EnablePort", "2") + gated("TriggerPort", "3")
    root += gated("EnablePort", "4", OutputWhenDisabled="reset", InitialOutput="-7")
    root += "".join(block("Outport", f"y{i}", 10 + i, Port=i) for i in (1, 2, 3))
    root += line("1#out:1", "2#enable", "3#trigger", "4#enable")
    root += "".join(line(f"{i + 1}#out:1", f"{10 + i}#in:1") for i in (1, 2, 3))
    (u,) = given(1)
    found = run(import_simulink(single_file(tmp_path / "m.slx", root), 0.01), u)
    on = u > 0
    rises = on & ~np.concatenate([[True], on[:-1]])
    wanted = np.stack([np.cumsum(on), np.cumsum(rises), np.where(on, np.cumsum(on), -7)], axis=1)
    assert np.array_equal(found, wanted)


def test_a_local_tag_belongs_to_its_system(tmp_path: Path) -> None:
    """Two subsystems use one tag for different signals; a global one crosses the border."""

    def inner(gain: int) -> str:
        text = block("Inport", "i", "x1") + block("Gain", "K", "x2", Gain=gain)
        text += block("Goto", "G", "x3", GotoTag="t") + block("From", "F", "x4", GotoTag="t")
        text += block("From", "W", "x5", GotoTag="wide") + block("Sum", "S", "x6", Ports="[2, 1]")
        text += block("Outport", "o", "x7") + line("x1#out:1", "x2#in:1")
        text += line("x2#out:1", "x3#in:1") + line("x4#out:1", "x6#in:1")
        return f"<System>{text}{line('x5#out:1', 'x6#in:2')}{line('x6#out:1', 'x7#in:1')}</System>"

    root = block("Inport", "u", 1) + block("SubSystem", "A", 2, inner(2))
    root += block("SubSystem", "B", 3, inner(5)) + block("Outport", "y", 4)
    root += block("Goto", "G", 5, GotoTag="wide", TagVisibility="global")
    root += line("1#out:1", "2#in:1", "5#in:1") + line("2#out:1", "3#in:1")
    root += line("3#out:1", "4#in:1")
    (u,) = given(1)
    found = run(import_simulink(single_file(tmp_path / "m.slx", root), 0.01), u)
    assert np.allclose(found, 5 * (2 * u + u) + u)


def test_a_masked_block_of_a_library_beside_the_model_is_put_in(tmp_path: Path) -> None:
    """Its parameters are those of the link, evaluated where the link is."""
    inner = block("Inport", "i", "x1") + block("Gain", "K", "x2", Gain="k*2")
    inner += block("Outport", "o", "x3") + line("x1#out:1", "x2#in:1") + line("x2#out:1", "x3#in:1")
    mask = '<Mask><MaskParameter Name="k"><Value>100</Value></MaskParameter></Mask>'
    single_file(tmp_path / "lib.slx", block("SubSystem", "Twice k", 1,
                f"{mask}<System>{inner}</System>"))  # fmt: skip
    link = '<InstanceData><P Name="k">base+1</P></InstanceData>'
    root = block("Inport", "u", 1) + block("Outport", "y", 3)
    root += block("Reference", "Mine", 2, link, SourceBlock="lib/Twice&#xA;k")
    root += line("1#out:1", "2#in:1") + line("2#out:1", "3#in:1")
    path = single_file(tmp_path / "m.slx", root)
    (u,) = given(1)
    assert np.allclose(run(import_simulink(path, 0.01, {"base": 2.0}), u), 6 * u)
    (tmp_path / "lib.slx").unlink()
    with pytest.raises(DesignError) as caught:
        import_simulink(path, 0.01)
    assert "the library block 'lib/Twice k' is not at hand" in caught.value.detail


def test_tables_by_index_and_over_two_inputs(tmp_path: Path) -> None:
    """Prelookup with interpolation beside numpy; two dimensions beside scipy."""
    root = block("Inport", "u", 1) + block("Inport", "v", 2, Port=2)
    root += block("PreLookup", "P", 3, BreakpointsData="[-2 -1 0.5 2]", Ports="[1, 2]")
    root += block("Interpolation_n-D", "I", 4, Table="[4 0 1 -3]", Ports="[2, 1]")
    root += block("Lookup_n-D", "T", 5, NumberOfTableDimensions="2", ExtrapMethod="Clip",
                  BreakpointsForDimension1="[-2 0 2]", BreakpointsForDimension2="[-1 1 2 3]",
                  Table="[1 2 3 0; 4 5 -6 1; 7 0 9 2]", Ports="[2, 1]")  # fmt: skip
    root += block("Outport", "a", 6) + block("Outport", "b", 7, Port=2)
    root += line("1#out:1", "3#in:1", "5#in:1") + line("2#out:1", "5#in:2")
    root += line("3#out:1", "4#in:1") + line("3#out:2", "4#in:2")
    root += line("4#out:1", "6#in:1") + line("5#out:1", "7#in:1")
    u, v = given(2)
    found = run(import_simulink(single_file(tmp_path / "m.slx", root), 0.01), u, v)
    assert np.allclose(found[:, 0], np.interp(u, [-2, -1, 0.5, 2], [4, 0, 1, -3]), atol=1e-5)
    table = [[1, 2, 3, 0], [4, 5, -6, 1], [7, 0, 9, 2]]
    plane = RegularGridInterpolator(([-2, 0, 2], [-1, 1, 2, 3]), np.array(table, float))
    wanted = plane(np.stack([np.clip(u, -2, 2), np.clip(v, -1, 3)], axis=1))
    assert np.allclose(found[:, 1], wanted, atol=1e-4)


def test_a_rate_is_inherited_from_the_source(tmp_path: Path) -> None:
    """A delay behind a slower hold delays by one of its samples."""
    root = block("Inport", "u", 1) + block("ZeroOrderHold", "H", 2, SampleTime="0.02")
    root += block("UnitDelay", "D", 3, SampleTime="-1") + block("Outport", "y", 4)
    root += line("1#out:1", "2#in:1") + line("2#out:1", "3#in:1") + line("3#out:1", "4#in:1")
    (u,) = given(1)
    found = run(import_simulink(single_file(tmp_path / "m.slx", root), 0.01), u)
    slow = np.concatenate([[0.0], u[::2][:-1]])
    assert np.array_equal(found, np.repeat(slow, 2))


def test_a_loop_through_a_continuous_block_is_held_not_refused(tmp_path: Path) -> None:
    """A first-order lag from an integrator in a loop, beside the exact response."""
    root = block("Constant", "One", 1, Value="1") + block("Sum", "E", 2, Inputs="+-",
                 Ports="[2, 1]")  # fmt: skip
    root += block("Integrator", "I", 3) + block("Outport", "y", 4)
    root += line("1#out:1", "2#in:1") + line("2#out:1", "3#in:1")
    root += line("3#out:1", "4#in:1", "2#in:2")
    found = run(import_simulink(single_file(tmp_path / "m.slx", root), 0.01))
    assert np.allclose(found, 1 - np.exp(-0.01 * np.arange(40)), atol=2e-3)


def test_a_model_without_outports_gives_what_its_scopes_show(tmp_path: Path) -> None:
    """And a block that is commented out is not there."""
    root = block("Constant", "C", 1, Value="2.5") + block("Scope", "View", 2, Ports="[1]")
    root += block("S-Function", "Off", 3, Commented="on") + line("1#out:1", "2#in:1", "3#in:1")
    assert run(import_simulink(single_file(tmp_path / "m.slx", root), 0.01))[-1] == 2.5


def test_a_workspace_is_read_from_assignments(tmp_path: Path) -> None:
    """Without running it; what is not understood is left out."""
    path = tmp_path / "init.m"
    path.write_text(
        "clear; close all % nothing\nTs = 1e-3;  % [s]\nn = [1 2 ...\n 3]; m.k = n(2)*Ts\n"
        "name = 'text'; h = figure;\n%{\nTs = 5;\n%}\ng = 0:2:6; t = sin(pi/6);\n"
    )
    found = read_workspace(path)
    assert {name: np.ravel(value).tolist() for name, value in found.items()} == {
        "Ts": [1e-3], "n": [1, 2, 3], "m.k": [2e-3], "g": [0, 2, 4, 6],
        "t": [pytest.approx(0.5)],
    }  # fmt: skip


def test_what_lies_outside_is_said_by_path(tmp_path: Path) -> None:
    """Charts, programs, physical ports, devices: each with its reason."""
    root = block("S-Function", "Chart", 1, FunctionName="sf_sfun") + block("PMIOPort", "P", 2)
    root += block("Reference", "Pin", 3, SourceBlock="arduinolib/Digital Output")
    root += block("S-Function", "Mine", 4, FunctionName="own") + block("Outport", "y", 5)
    root += line("4#out:1", "5#in:1")
    with pytest.raises(DesignError) as caught:
        import_simulink(single_file(tmp_path / "m.slx", root), 0.01)
    for text in (
        "Chart (S-Function): a Stateflow chart, or a MATLAB function of a .mdl file",
        "P (PMIOPort): physical modelling",
        "Pin (Reference): the library block 'arduinolib/Digital Output' is not at hand",
        "Mine (S-Function): an S-Function, a program in another language",
    ):
        assert text in caught.value.detail
