# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Functions in MATLAB's language become blocks: interpreted ones and MATLAB Function blocks."""

from __future__ import annotations

import ctypes
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from verification.support.codegen.c_build import host_library
from verification.support.codegen.simulink_files import FIRST, block, line, run, single_file

from ravenbrick.codegen import check_program, generate_c, random_vectors
from ravenbrick.errors import DesignError
from ravenbrick.model import Diagram
from ravenbrick.simulink import import_simulink, survey_simulink

STEPS = 60
ARM = """\
function acc = arm(u)
% Two joints: the inverse of the inertia times torques.
m1 = 1.5; m2 = 0.8; l = [0.4 0.3];   % masses and lengths
q = u(1:2); tau = u(3:end);
c = cos(q(2));
M = [m1*l(1)^2 + m2*(l(1)^2 + l(2)^2 + 2*l(1)*l(2)*c), ...
     m2*(l(2)^2 + l(1)*l(2)*c)
     m2*(l(2)^2 + l(1)*l(2)*c)  m2*l(2)^2];
acc = inv(M)*(tau - [l(1)*sin(q(1)); 0]);
end
"""


def arm(q: np.ndarray, tau: np.ndarray) -> np.ndarray:
    """The same with numpy."""
    m1, m2, l1, l2 = 1.5, 0.8, 0.4, 0.3
    c = np.cos(q[1])
    off = m2 * (l2**2 + l1 * l2 * c)
    first = m1 * l1**2 + m2 * (l1**2 + l2**2 + 2 * l1 * l2 * c)
    load = tau - np.array([l1 * np.sin(q[0]), 0.0])
    return np.asarray(np.linalg.solve([[first, off], [off, m2 * l2**2]], load))


def muxed(kind: str, count: int, outputs: int, **parameters: Any) -> str:
    """Inports through a Mux into a block whose elements go to outports."""
    root = "".join(block("Inport", f"u{i}", f"i{i}", Port=i) for i in range(1, count + 1))
    root += block("Mux", "M", "m", Inputs=count, Ports=f"[{count}, 1]")
    root += block(kind, "B", "b", Ports="[1, 1]", **parameters)
    root += "".join(line(f"i{i}#out:1", f"m#in:{i}") for i in range(1, count + 1))
    root += line("m#out:1", "b#in:1") + block("Demux", "D", "d", Outputs=outputs)
    root += line("b#out:1", "d#in:1")
    for place in range(1, outputs + 1):
        root += block("Outport", f"y{place}", f"o{place}", Port=place)
        root += line(f"d#out:{place}", f"o{place}#in:1")
    return root


def given(count: int) -> list[np.ndarray]:
    """Inputs within 2; the first is 0."""
    random = np.random.default_rng(11)
    found = [np.round(random.uniform(-2, 2, STEPS) * 16) / 16 for _ in range(count)]
    found[0][0] = 0.0
    return found


EXPRESSIONS: dict[str, tuple[str, int, Callable[..., Any]]] = {
    "a name alone is applied to the input": ("sin", 1, np.sin),
    "sinc has no gap at 0": ("exp(sinc(u))+tanh(u)", 1, lambda a: np.exp(np.sinc(a)) + np.tanh(a)),
    "the square of a vector": ("u'*u", 3, lambda a, b, c: a * a + b * b + c * c),
    "elements": ("atan2(u(1), u(end))", 2, lambda a, b: np.arctan2(a + 0.0, b)),
    "a quadratic form": ("u'*[2 1;0 3]*u", 2, lambda a, b: 2 * a * a + a * b + 3 * b * b),
    "element by element": ("sum(u.^2./(1+abs(u)))", 2,
                           lambda a, b: a * a / (1 + abs(a)) + b * b / (1 + abs(b))),
    "the largest": ("max(u) - min(u)", 3,
                    lambda a, b, c: np.max([a, b, c], 0) - np.min([a, b, c], 0)),
    "hyperbolic": ("sinh(u(1)) + cosh(u(2))", 2, lambda a, b: np.sinh(a) + np.cosh(b)),
    "a comparison as a number": ("2*(u(1) > u(2)) - 1", 2, lambda a, b: np.where(a > b, 1.0, -1.0)),
    "a norm": ("norm(u)", 2, np.hypot),
}  # fmt: skip


@pytest.mark.parametrize("name", EXPRESSIONS)
def test_an_interpreted_expression_is_that_of_numpy(name: str, tmp_path: Path) -> None:
    """Of one input or of several, as one number."""
    text, ports, reference = EXPRESSIONS[name]
    text = text.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")
    root = muxed("MATLABFcn", ports, 1, MATLABFcn=text)
    inputs = given(ports)
    diagram = import_simulink(single_file(tmp_path / "m.slx", root), 0.01)
    assert run(diagram, *inputs) == pytest.approx(reference(*inputs), rel=1e-4, abs=1e-5)


def assert_same_bits(diagram: Diagram, folder: Path) -> None:
    """The C gives what the simulation does."""
    generate_c(diagram).write(folder)
    (folder / "check.c").write_text(check_program(random_vectors(diagram, 200, seed=3)))
    ports = "ExternalInputs_m m_U;\nExternalOutputs_m m_Y;\n"
    (folder / "ports.c").write_text(f'#include "m.h"\n{ports}')
    library = host_library(folder, "m.c", "check.c", "ports.c")
    library.m_check()
    assert ctypes.c_uint32.in_dll(library, "m_check_steps").value == 200
    assert ctypes.c_uint32.in_dll(library, "m_check_failures").value == 0


def arm_model(folder: Path) -> Path:
    """The arm's function beside a model that calls it."""
    (folder / "arm.m").write_text(ARM)
    parameters = {"MATLABFcn": "arm(u)", "OutputDimensions": "2", "Output1D": "off"}
    return single_file(folder / "m.slx", muxed("MATLABFcn", 4, 2, **parameters))


def test_a_function_of_a_file_beside_the_model_is_written_out(tmp_path: Path) -> None:
    """Matrices of signals, their inverse, and lines that go on; simulation and C agree."""
    diagram = import_simulink(arm_model(tmp_path), 0.01)
    inputs = given(4)
    wanted = [arm(row[:2], row[2:]) for row in np.transpose(inputs)]
    assert run(diagram, *inputs) == pytest.approx(np.array(wanted), rel=2e-4, abs=1e-3)
    assert_same_bits(diagram, tmp_path)
    waves = [one for one in diagram.blocks if type(one).__name__ == "Trigonometry"]
    assert len(waves) == 2  # what is computed twice is one block


PROGRAM = """\
function [y, mode] = fcn(u, limit)
%#codegen
persistent total n
if isempty(total)
    total = 0;
    n = 0;
end
n = n + 1;
total = total + u;
y = 0;
for k = 1:3
    y = y + scaled(total, k);
end
if y &gt; limit
    y = limit; mode = 1;
elseif y &lt; -limit
    y = -limit; mode = -1;
else
    mode = 0;
end
switch n
    case {3, 4}
        mode = 7;
    otherwise
        mode = mode;
end
end
function z = scaled(x, k)
z = x^k / k;
end
"""


def chart_model(
    path: Path, program: str, *, inputs: int = 1, outputs: int = 2, newer: bool = False
) -> Path:
    """A MATLAB Function block as Simulink writes it: a subsystem with an S-Function and a chart.

    Since R2020 each chart has a file of its own, and the tag does not name the model.
    """
    inner = "".join(block("Inport", f"u{i}", f"1::i{i}", Port=i) for i in range(1, inputs + 1))
    tag = f"Stateflow S-Function {'' if newer else 'm '}3"
    inner += block("S-Function", " SFunction ", "1::s", FunctionName="sf_sfun",
                   Tag=tag, Ports=f"[{inputs}, {outputs + 1}]")  # fmt: skip
    inner += block("Demux", " Demux ", "1::d", Outputs=1) + block("Terminator", "T", "1::t")
    inner += line("1::s#out:1", "1::d#in:1") + line("1::d#out:1", "1::t#in:1")
    inner += "".join(line(f"1::i{i}#out:1", f"1::s#in:{i}") for i in range(1, inputs + 1))
    root = "".join(block("Inport", f"in{i}", f"i{i}", Port=i) for i in range(1, inputs + 1))
    root += block("SubSystem", "MATLAB Function", 1, "{inner}", Ports=f"[{inputs}, {outputs}]",
                  SFBlockType="MATLAB Function")  # fmt: skip
    root += "".join(line(f"i{i}#out:1", f"1#in:{i}") for i in range(1, inputs + 1))
    for place in range(1, outputs + 1):
        inner += block("Outport", f"y{place}", f"1::o{place}", Port=place)
        inner += line(f"1::s#out:{place + 1}", f"1::o{place}#in:1")
        root += block("Outport", f"out{place}", f"o{place}", Port=place)
        root += line(f"1#out:{place}", f"o{place}#in:1")
    single_file(path, root.replace("{inner}", f"<System>{inner}</System>"))
    limit = '<data name="limit"><P Name="scope">PARAMETER_DATA</P></data>'
    chart = (
        '<chart id="5"><P Name="type">EML_CHART</P>'
        '<P Name="chartFileNumber">3</P><Children><state><eml><P Name="isEML">1</P>'
        f'<P Name="script">{program}</P></eml></state>'
        f"{limit if 'limit' in program else ''}</Children></chart>"
    )
    whole = f"<Stateflow><machine><Children>{chart}</Children></machine></Stateflow>"
    with zipfile.ZipFile(path, "a") as archive:
        if newer:
            archive.writestr("simulink/stateflow/machine.xml", f"{FIRST}<machine/>")
            archive.writestr("simulink/stateflow/chart_5.xml", FIRST + chart)
        else:
            archive.writestr("simulink/stateflow.xml", FIRST + whole)
    return path


@pytest.mark.parametrize("newer", [False, True])
def test_a_matlab_function_block_has_branches_loops_and_memory(
    tmp_path: Path, *, newer: bool
) -> None:
    """A parameter of the workspace, an own function, persistent variables, `switch`."""
    path = chart_model(tmp_path / "m.slx", PROGRAM, newer=newer)
    (u,) = given(1)
    wanted, total = [], 0.0
    for step, value in enumerate(u, 1):
        total += value
        y = total + total**2 / 2 + total**3 / 3
        mode = 7.0 if step in (3, 4) else float(np.sign(y)) if abs(y) > 5 else 0.0
        wanted.append([min(max(y, -5.0), 5.0), mode])
    diagram = import_simulink(path, 0.01, {"limit": 5.0})
    assert run(diagram, u) == pytest.approx(np.array(wanted), rel=1e-4, abs=1e-4)
    assert_same_bits(diagram, tmp_path)


def test_a_number_of_turns_may_come_from_a_constant(tmp_path: Path) -> None:
    """Through a Mux; the constant is then part of the program, not tunable."""
    (tmp_path / "series.m").write_text(
        "function y = series(x, n)\ny = 0;\nfor k = 1:n\n  y = y + x^k;\nend\n"
    )
    root = block("Inport", "x", 1) + block("Constant", "n", 2, Value="turns")
    root += block("Mux", "M", 3, Inputs=2) + block("Outport", "y", 5)
    root += block("MATLABFcn", "F", 4, MATLABFcn="series(u(1), u(2))", OutputDimensions="1")
    root += line("1#out:1", "3#in:1") + line("2#out:1", "3#in:2") + line("3#out:1", "4#in:1")
    path = single_file(tmp_path / "m.slx", root + line("4#out:1", "5#in:1"))
    (x,) = given(1)
    diagram = import_simulink(path, 0.01, {"turns": 3.0})
    assert run(diagram, x) == pytest.approx(x + x**2 + x**3, rel=1e-5, abs=1e-5)


REFUSED = {
    "roots(u)": "the function 'roots' has no counterpart for signals",
    "u(round(u(1)))": "an index that is a signal",
    "inv(u*u'*ones(3))": None,
    "u*u": "a matrix with 1 columns times one with 3 rows",
    "zeros(u(1))": "the function 'zeros' has no counterpart for signals",
    "missing(u)": "'missing'",
    "u(2, 2)": "row or column 2 of a matrix of 3 x 1",
    "strcat('a', u)": "text in quotes",
}


@pytest.mark.parametrize("text", REFUSED)
def test_an_expression_without_counterpart_is_refused_with_what_it_is(
    text: str, tmp_path: Path
) -> None:
    """And the advice what to do; a matrix of 3 x 3 can be inverted."""
    root = muxed("MATLABFcn", 3, 1, MATLABFcn=text)
    path = single_file(tmp_path / "m.slx", root)
    if REFUSED[text] is None:
        reasons = [refusal.reason for refusal in survey_simulink(path).refusals]
        assert not any("inverse" in reason for reason in reasons)
        return
    with pytest.raises(DesignError) as error:
        import_simulink(path, 0.01)
    assert f"B (MATLABFcn): in '{text}': " in str(error.value.detail)
    assert str(REFUSED[text]) in str(error.value.detail)
    assert "draw this part with blocks" in str(error.value.detail)


BROKEN = {
    "y = u;\nwhile y > 1\n y = y/2;\nend": "f.m:3: the statement 'while' has no counterpart",
    "y = u;\nz = undone(y);": "f.m:3: the function 'undone' has no counterpart",
    "if u > 0\n y = 1;": "f.m:3: an 'end' is missing",
    "if u > 0\n y = [1 2];\nelse\n y = 1;\nend": "f.m:2: the branches give 'y' different sizes",
    "x = u;": "f.m: nothing is assigned to the output 'y'",
    "persistent k\ny = u;": "f.m: the persistent variable 'k' has no first value",
    "for k = 1:u\n y = k;\nend": "f.m:2: ",
    "y = f(u);": "functions call each other more than 20 deep",
}


@pytest.mark.parametrize("body", BROKEN)
def test_a_program_without_counterpart_is_refused_with_file_and_line(
    body: str, tmp_path: Path
) -> None:
    """Nothing is written, nothing loops."""
    (tmp_path / "f.m").write_text(f"function y = f(u)\n{body}\n")
    root = muxed("MATLABFcn", 1, 1, MATLABFcn="f(u)", OutputDimensions="1")
    path = single_file(tmp_path / "m.slx", root)
    with pytest.raises(DesignError) as error:
        import_simulink(path, 0.01)
    assert BROKEN[body] in str(error.value.detail)


def test_a_matlab_function_block_that_is_refused_does_not_lie_outside(tmp_path: Path) -> None:
    """Its elements are then as many as others ask for."""
    path = chart_model(tmp_path / "m.slx", "function y = f(u)\ny = fft(u);\nend", outputs=1)
    (refusal,) = survey_simulink(path).refusals
    assert not refusal.outside and refusal.kind == "MATLABFunction"
    assert "its program:2: the function 'fft' has no counterpart for signals" in refusal.reason


def test_output_dimensions_that_do_not_fit_are_refused(tmp_path: Path) -> None:
    """With the number that would."""
    root = muxed("MATLABFcn", 3, 1, MATLABFcn="[u; u]", OutputDimensions="3")
    path = single_file(tmp_path / "m.slx", root)
    with pytest.raises(DesignError) as error:
        import_simulink(path, 0.01)
    assert "gives 6 elements, its dialog says 3" in str(error.value.detail)


def test_complex_numbers_are_refused_by_name(tmp_path: Path) -> None:
    """Signals are real numbers."""
    root = block("Constant", "C", 1, Value="3i/2") + block("Outport", "y", 2)
    path = single_file(tmp_path / "m.slx", root + line("1#out:1", "2#in:1"))
    with pytest.raises(DesignError) as error:
        import_simulink(path, 0.01)
    assert "'3i/2' is complex" in str(error.value.detail)
