# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Linear systems and designs in the programs that prepare a model's variables."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner
from verification.support.codegen.simulink_files import block, line, single_file

from ravenbrick.cli.app import app
from ravenbrick.simulink import read_workspace
from ravenbrick.simulink.numbers import Workspace

# The plant of NXTway-GS by its published constants (Y. Yamamoto, 2008, sections 3 and 5).
NXTWAY = """
g = 9.81; m = 0.03; r = 0.04; M = 0.6; L = 0.072; Jm = 1e-5; Rm = 6.69; Kb = 0.468; Kt = 0.317;
fm = 0.0022; a = Kt/Rm; b = a*Kb + fm;
E = [(2*m + M)*r^2 + 2*(m*r^2/2) + 2*Jm, M*L*r - 2*Jm; ...
     M*L*r - 2*Jm, M*L^2 + M*L^2/3 + 2*Jm];
F = 2*[b -b; -b b]; G = [0 0; 0 -M*g*L]; H = [a a; -a -a];
A = [zeros(2) eye(2); -E\\G -E\\F];
B = [zeros(2); E\\H];
Ai = [A zeros(4,1); 1 0 0 0 0]; Bi = [B; 0 0];
[K, S, e] = lqr(Ai, Bi, diag([1 6e5 1 1 4e2]), 1e3*eye(2));
k_f = K(1,1:4); k_i = K(1,5);
"""


def read(folder: Path, text: str) -> Workspace:
    """The variables that a program leaves."""
    path = folder / "init.m"
    path.write_text(text)
    return read_workspace(path)


def rows(value: object) -> list[list[float]]:
    """A matrix as lists."""
    found: list[list[float]] = np.asarray(value, dtype=float).tolist()
    return found


def test_the_published_gains_of_nxtway_come_out_of_lqr(tmp_path: Path) -> None:
    """To all digits that are published."""
    found = read(tmp_path, NXTWAY)
    published = [-0.83508, -34.18958, -1.29354, -2.81409]
    assert np.round(np.ravel(found["k_f"]), 5).tolist() == published
    assert np.round(np.ravel(found["k_i"]), 5).tolist() == [-0.44721]


def test_designs_whose_results_are_known_in_closed_form(tmp_path: Path) -> None:
    """The scalar regulator is the golden ratio; the double integrator by its polynomial."""
    found = read(
        tmp_path,
        "[K, S, e] = dlqr(1, 1, 1, 1); C = lqr(1, 1, 3, 1);\n"
        "R = lqr(ss(1, 1, 1, 0, 0.1), 1, 1, []);\n"
        "A = [0 1; 0 0]; B = [0; 1]; P = place(A, B, [-2 -3]); Q = acker(A, B, [-3 -3]);\n"
        "[L, ~] = lqe(0, 1, 1, 4, 1); Lo = place(A', [1; 0], [-4 -5])';\n"
        "N = -place(A, B, [-2 -3])/2;",
    )
    golden = (1 + math.sqrt(5)) / 2
    assert np.ravel(found["S"]) == pytest.approx([golden])
    assert np.ravel(found["K"]) == pytest.approx([1 / golden])
    assert np.ravel(found["R"]) == pytest.approx([1 / golden])
    assert np.ravel(found["e"]) == pytest.approx([1 - 1 / golden])
    assert np.ravel(found["C"]) == pytest.approx([1 + 2])  # p^2 - 2 p = 3
    assert rows(found["P"]) == [pytest.approx([6, 5])]
    assert rows(found["Q"]) == [pytest.approx([9, 6])]
    assert np.ravel(found["L"]) == pytest.approx([2])
    assert rows(found["Lo"]) == [pytest.approx([9]), pytest.approx([20])]
    assert rows(found["N"]) == [pytest.approx([-3, -2.5])]


def test_systems_are_sampled_as_textbooks_say(tmp_path: Path) -> None:
    """A double integrator, a lag with held inputs, by Tustin and by matched roots."""
    found = read(
        tmp_path,
        "Ts = 0.1; sys = ss([0 1; 0 0], [0; 1], eye(2), []); d = c2d(sys, Ts, 'zoh');\n"
        "Ad = d.A; Bd = d.B; T = d.Ts; [Ao, Bo] = c2d([0 1; 0 0], [0; 1], Ts);\n"
        "G = tf(2, [0.5 1]); Gd = c2d(G, Ts); num = Gd.Num{:}; den = Gd.Denominator{1};\n"
        "Gt = c2d(G, Ts, 'tustin'); nt = Gt.num{1}; dt = Gt.den{1};\n"
        "[nm, dm] = tfdata(c2d(G, Ts, \"matched\"), 'v'); [a, b, c, e] = ssdata(sys);",
    )
    for names in (("Ad", "Bd"), ("Ao", "Bo")):
        assert np.asarray(found[names[0]]) == pytest.approx(np.array([[1, 0.1], [0, 1]]))
        assert np.ravel(found[names[1]]) == pytest.approx([0.005, 0.1])
    pole = math.exp(-0.2)
    assert np.ravel(found["T"]) == [0.1]
    assert np.ravel(found["num"]) == pytest.approx([0, 2 * (1 - pole)])
    assert np.ravel(found["den"]) == pytest.approx([1, -pole])
    # 2 / (0.5 s + 1) with s = 20 (z - 1) / (z + 1)
    assert np.ravel(found["nt"]) == pytest.approx([2 / 11, 2 / 11])
    assert np.ravel(found["dt"]) == pytest.approx([1, -9 / 11])
    assert np.ravel(found["dm"]) == pytest.approx([1, -pole])
    assert np.sum(found["nm"]) / np.sum(found["dm"]) == pytest.approx(2)
    assert rows(found["a"]) == [[0, 1], [0, 0]] and rows(found["e"]) == [[0], [0]]


def test_transfer_functions_are_combined(tmp_path: Path) -> None:
    """With numbers, with each other, and closed."""
    found = read(
        tmp_path,
        "s = tf('s'); G = 5/(s^2 + 2*s); C = 3 + 4/s; W = feedback(3*G, 1);\n"
        "[n, d] = tfdata(G, 'v'); p = C.num{1}; q = W.den{1}; m = -G; r = m.num{1};",
    )
    assert np.ravel(found["n"]).tolist() == [0, 0, 5]
    assert np.ravel(found["d"]).tolist() == [1, 2, 0]
    assert np.ravel(found["p"]) == pytest.approx([3, 4])
    assert np.ravel(found["q"]) == pytest.approx([1, 2, 15])
    assert np.ravel(found["r"]) == pytest.approx([0, 0, -5])


def test_what_has_no_result_is_left_out(tmp_path: Path) -> None:
    """And does not keep an older value; what follows is read."""
    found = read(
        tmp_path,
        "K = 1; K = lqr([1 0; 0 2], [0; 0], eye(2), 1);\nP = 2; P = place([0 1; 0 0], [0; 1]);\n"
        "[a, b] = lqr(1, 1, 1); G = c2d(tf(1, [1 1]), 0.1, 'guess'); t = '1';\n"
        "M = ss(1, [1 1], 1, 0);\n"
        "n = M.num; [k, ~, e] = lqr([0 1; 0 0], [0; 1], eye(2), 1); B = lqr(zeros(300), 1, 1, 1);\n"
        "z = tf(1, [1 1])(1); y = tf(1, [1 1]) < 2; last = 7;",
    )
    assert {name: np.ravel(value).tolist() for name, value in found.items() if "." not in name} == {
        "k": [pytest.approx(1), pytest.approx(math.sqrt(3))], "last": [7],
    }  # fmt: skip


def test_a_model_runs_with_the_gains_that_its_program_computes(tmp_path: Path) -> None:
    """The loop has the poles that were asked for: 1 - (1 + 2 t) exp(-2 t) after one second."""
    program = tmp_path / "init.m"
    program.write_text("A = [0 1; 0 0]; B = [0; 1]; K = place(A, B, [-2.0001 -2]); N = K(1);")
    root = block("Step", "r", 1, Time="0") + block("Gain", "N", 2, Gain="N")
    root += block("StateSpace", "P", 3, A="A - B*K", B="B", C="[1 0]", D="0")
    root += block("Outport", "y", 4) + line("1#out:1", "2#in:1") + line("2#out:1", "3#in:1")
    root += line("3#out:1", "4#in:1")
    model = single_file(tmp_path / "m.slx", root)
    words = ["simulate", str(model), "--stop", "1", "--workspace", str(program), "--json"]
    done = CliRunner().invoke(app, words)
    assert done.exit_code == 0, done.output
    (signal,) = json.loads(done.output)["signals"]
    assert signal["values"][-1] == pytest.approx(1 - 3 * math.exp(-2), abs=1e-4)


def test_a_system_that_grows_without_end_is_not_computed(tmp_path: Path) -> None:
    """A power, or squares of squares, would take hours."""
    found = read(tmp_path, "G = tf(1, [1 1]); H = G^100000;" + "G = G*G;" * 40 + "k = G.Ts;")
    assert "H.Ts" not in found and "k" not in found


FUNCTIONS = {
    "eig([2 1; 1 2])": [[1.0], [3.0]],
    "roots([1 -3 2])": [[1.0], [2.0]],
    "poly([1 2])": [[1.0, -3.0, 2.0]],
    "poly([0 1; -2 -3])": [[1.0, 3.0, 2.0]],
    "conv([1 1], [1 2 3])": [[1.0, 3.0, 5.0, 3.0]],
    "kron([1 2], [1; 1])": [[1.0, 2.0], [1.0, 2.0]],
    "rank([1 2; 2 4])": [[1.0]],
    "expm([0 1; 0 0])": [[1.0, 1.0], [0.0, 1.0]],
    "diff([1 4 9])": [[3.0, 5.0]],
    "cumsum([1 2 3])": [[1.0, 3.0, 6.0]],
    "repmat([1 2], 2, 1)": [[1.0, 2.0], [1.0, 2.0]],
    "logspace(0, 2, 3)": [[1.0, 10.0, 100.0]],
    "fliplr([1 2])": [[2.0, 1.0]],
    "lyap(-1, 2)": [[1.0]],  # -x - x + 2 = 0
    "dlyap(0.5, 3)": [[4.0]],  # x / 4 - x + 3 = 0
    "care(0, 1, 1)": [[1.0]],  # -x^2 + 1 = 0
}


@pytest.mark.parametrize("text", FUNCTIONS)
def test_a_function_of_matrices_has_the_value_of_its_definition(text: str, tmp_path: Path) -> None:
    """Worked by hand."""
    found = rows(np.atleast_2d(read(tmp_path, f"x = {text};")["x"]))
    assert np.array(found) == pytest.approx(np.array(FUNCTIONS[text]), abs=1e-9)


@pytest.mark.parametrize("text", ["eig([0 1; -1 0])", "roots([1 0 1])", "kron(ones(400), ones(9))",
                                  "conv(ones(1, 2000), 1)", "repmat(1, 1000, 1000)"])  # fmt: skip
def test_complex_and_huge_results_are_no_variables(text: str, tmp_path: Path) -> None:
    """The name is then missing where a block wants it."""
    assert "x" not in dict.keys(read(tmp_path, f"x = {text};"))


def test_two_results_of_a_size_and_systems_of_poles(tmp_path: Path) -> None:
    """Rows and columns; a system of its zeros, poles and gain in series and in parallel."""
    found = read(
        tmp_path,
        "[n, m] = size([1 2 3; 4 5 6]); G = zpk([], [-1 -2], 6); H = series(G, tf(1, [1 3]));\n"
        "P = parallel(tf(1, [1 1]), tf(1, [1 2])); [X, K, L] = icare(0, 1, 4, 1);\n",
    )
    assert [float(np.ravel(found[name])[0]) for name in "nm"] == [2, 3]
    assert np.ravel(found["G.den"]) == pytest.approx([1, 3, 2])
    assert np.ravel(found["H.den"]) == pytest.approx([1, 6, 11, 6])
    assert np.ravel(found["P.num"]) == pytest.approx([0, 2, 3])
    assert [float(np.ravel(found[name])[0]) for name in "XKL"] == pytest.approx([2, 2, -2])


def test_a_riccati_equation_with_parts_left_out(tmp_path: Path) -> None:
    """R left out is 1, S and G are 0: 4 - x^2 = 0; with E = 2 it is 4 - 4 x^2 = 0."""
    found = read(
        tmp_path,
        "X = icare(0, 1, 4, [], 0, [], 0); Y = icare(0, 1, 4, 1, [], 2);\n"
        "Z = icare(0, 1, 4, 1, 0, 1, 3);",
    )
    assert [float(np.ravel(found[name])[0]) for name in "XY"] == pytest.approx([2, 1])
    assert "Z" not in dict.keys(found)
