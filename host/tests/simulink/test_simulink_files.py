# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Ways of writing model files, scripts beside them, matrices, models without an outport."""

from __future__ import annotations

import base64
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from verification.support.codegen.simulink_files import (
    FIRST,
    VARIABLES,
    block,
    line,
    run,
    single_file,
    whole_model,
)

from ravenbrick.errors import DesignError
from ravenbrick.simulink import ModelSource, import_simulink, survey_simulink
from ravenbrick.simulink.numbers import Workspace
from ravenbrick.simulink.simulate import simulate

ONE = block("Constant", "C", 1, Value="{value}") + block("Outport", "y", 2)
ONE += line("1#out:1", "2#in:1")


def model(path: Path, root: str, settings: str = "") -> Path:
    """A file with settings of the whole model."""
    inside = (
        f"<ModelInformation><Model>{settings}<System>{root}</System></Model></ModelInformation>"
    )
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("simulink/blockdiagram.xml", FIRST + inside)
    return path


def last(path: Path, **variables: float) -> Any:
    """All outputs of a model after some steps, its variables given."""
    return np.atleast_1d(run(import_simulink(path, 0.01, variables))[-1]).tolist()


def test_a_package_written_as_text_is_the_archive(tmp_path: Path) -> None:
    """An .mdl of today: the parts of the .slx with marks around them, binary ones in base 64."""
    archive = whole_model(tmp_path / "model.slx")
    with zipfile.ZipFile(archive) as opened:
        parts = {name: opened.read(name).decode() for name in opened.namelist()}
    text = "# MathWorks OPC Text Package\nModel {\n  Version  25.2\n}\n"
    text += "__MWOPC_PACKAGE_BEGIN__ R2025b\n"
    text += "__MWOPC_PART_BEGIN__ /simulink/bdmxdata/x.mxarray BASE64\n"
    text += base64.b64encode(b"\0\1{}").decode() + "\n"
    for name, part in parts.items():
        text += f"__MWOPC_PART_BEGIN__ /{name}\n{part}\n\n"
    text += '__MWOPC_PART_BEGIN__ /simulink/graphicalInterface.json\n{"a": {\n}}}\n'
    written = tmp_path / "text.mdl"
    written.write_text(text + "__MWOPC_PACKAGE_END__\n")
    rising = np.linspace(0, 1, 40)
    one, two = (run(import_simulink(p, 0.01, VARIABLES), rising) for p in (archive, written))
    assert np.any(one) and np.array_equal(one, two)


def test_a_callback_names_a_script_beside_the_model(tmp_path: Path) -> None:
    """Which names another; a function of the same form is no script."""
    (tmp_path / "params.m").write_text("% all numbers\nK = 2;\nmore\nhelper\n")
    (tmp_path / "more.m").write_text("run('deep.m')\nL = K + 1;\n")
    (tmp_path / "deep.m").write_text("K = 5;\n")
    (tmp_path / "helper.m").write_text("function K = helper()\nK = 9;\n")
    path = model(tmp_path / "m.slx", ONE.format(value="10*K + L"),
                 '<P Name="InitFcn">params</P>')  # fmt: skip
    assert last(path) == [56.0]


def test_scripts_that_name_themselves_end(tmp_path: Path) -> None:
    """A script that runs itself is read a few times only."""
    (tmp_path / "again.m").write_text("K = 3;\nagain\n")
    path = model(tmp_path / "m.slx", ONE.format(value="K"), '<P Name="PreLoadFcn">again;</P>')
    assert last(path) == [3.0]


@pytest.mark.parametrize("folder", ["@sdpvar", "+tools", "private", "@a/private"])
def test_methods_of_classes_are_no_functions_of_a_model(folder: str, tmp_path: Path) -> None:
    """`sin` of a class somewhere in a library does not hide the function of that name."""
    (tmp_path / "lib" / folder).mkdir(parents=True)
    (tmp_path / "lib" / folder / "sin.m").write_text("function y = sin(x)\ny = 100*x;\n")
    root = block("Inport", "u", 1) + block("MATLABFcn", "F", 2, MATLABFcn="sin(u)")
    root += block("Outport", "y", 3) + line("1#out:1", "2#in:1") + line("2#out:1", "3#in:1")
    path = single_file(tmp_path / "m.slx", root)
    diagram = import_simulink(path, 0.01, {}, [tmp_path / "lib"])
    given = np.linspace(-1, 1, 9)
    assert run(diagram, given) == pytest.approx(np.sin(given), abs=1e-6)


def test_without_outport_and_scope_open_ends_are_shown(tmp_path: Path) -> None:
    """A signal at a terminator, and one that leads nowhere; one that is read is not."""
    root = block("Constant", "C", 1, Value="3") + block("Gain", "G", 2, Gain="2")
    root += block("Bias", "B", 3, Bias="1") + block("Terminator", "T", 4)
    root += line("1#out:1", "2#in:1", "3#in:1") + line("2#out:1", "4#in:1")
    found = simulate(
        ModelSource(single_file(tmp_path / "m.slx", root), 0.0, Workspace({}), ()), 1.0
    )
    assert {s.name: float(s.values[-1]) for s in found.signals} == {"G": 6.0, "B": 4.0}


def test_a_model_without_a_signal_is_refused(tmp_path: Path) -> None:
    """An empty subsystem has nothing to run."""
    path = single_file(tmp_path / "m.slx", block("SubSystem", "S", 1, "<System></System>"))
    with pytest.raises(DesignError, match="no signal to show"):
        import_simulink(path, 0.01)


def test_rows_and_columns_of_a_matrix_are_selected(tmp_path: Path) -> None:
    """All rows of two columns, a vector of rows and a starting column."""
    root = block("Constant", "C", 1, Value="[1 2 3; 4 5 6; 7 8 9]")
    parts = (
        ("Select all,Index vector (dialog)", "1,[3 1]", "1,1"),
        ("Index vector (dialog),Starting index (dialog)", "[3 2],2", "1,2"),
    )
    for place, (options, indices, sizes) in enumerate(parts, 2):
        root += block("Selector", f"S{place}", place, NumberOfDimensions="2", IndexOptions=options,
                      Indices=indices, OutputSizes=sizes)  # fmt: skip
        root += block("Outport", f"y{place}", place + 10, Port=place - 1)
        root += line(f"{place}#out:1", f"{place + 10}#in:1")
    path = single_file(tmp_path / "m.slx", root + line("1#out:1", "2#in:1", "3#in:1"))
    assert last(path) == [3, 6, 9, 1, 4, 7, 8, 5, 9, 6]


def test_a_place_beyond_the_matrix_is_refused(tmp_path: Path) -> None:
    """With its size."""
    root = block("Constant", "C", 1, Value="[1 2; 3 4]") + block("Outport", "y", 3)
    root += block("Selector", "S", 2, NumberOfDimensions="2", Indices="[1 3],1", OutputSizes="1,1",
                  IndexOptions="Index vector (dialog),Select all")  # fmt: skip
    root += line("1#out:1", "2#in:1") + line("2#out:1", "3#in:1")
    survey = survey_simulink(single_file(tmp_path / "m.slx", root))
    assert [r.reason for r in survey.refusals] == ["it selects elements beyond the 2 of its input"]


def test_matrices_are_divided(tmp_path: Path) -> None:
    """A times the inverse of B, and an inverse alone, as numpy has them."""
    left, right = np.array([[8.0, 6.0], [4.0, 9.0]]), np.array([[4.0, 3.0], [-2.0, 1.0]])
    root = block("Constant", "A", 1, Value="[8 6; 4 9]") + block(
        "Constant", "B", 2, Value="[4 3; -2 1]"
    )
    root += block("Product", "Q", 3, Inputs="*/", Multiplication="Matrix(*)", Ports="[2, 1]")
    root += block("Product", "I", 4, Inputs="/", Multiplication="Matrix(*)", Ports="[1, 1]")
    root += block("Outport", "q", 5, Port=1) + block("Outport", "i", 6, Port=2)
    root += line("1#out:1", "3#in:1") + line("2#out:1", "3#in:2", "4#in:1")
    root += line("3#out:1", "5#in:1") + line("4#out:1", "6#in:1")
    inverse = np.linalg.inv(right)
    expected = [*(left @ inverse).ravel(order="F"), *inverse.ravel(order="F")]
    assert last(single_file(tmp_path / "m.slx", root)) == pytest.approx(expected, abs=1e-6)


def test_a_transfer_function_of_degree_0_is_a_gain(tmp_path: Path) -> None:
    """3 / 2, in the import and in the simulation."""
    root = block("Constant", "C", 1, Value="4") + block("Outport", "y", 3)
    root += block("TransferFcn", "P", 2, Numerator="[3]", Denominator="[2]")
    path = single_file(
        tmp_path / "m.slx", root + line("1#out:1", "2#in:1") + line("2#out:1", "3#in:1")
    )
    assert last(path) == [6.0]
    found = simulate(ModelSource(path, 0.0, Workspace({}), ()), 1.0)
    assert found.signals[0].values[-1] == 6.0


def test_a_sample_time_that_no_block_needs_makes_no_samples(tmp_path: Path) -> None:
    """An integrator for ten days with `--sample-time`: its solver takes the steps it needs."""
    root = block("Step", "r", 1, Time="0") + block("Integrator", "I", 2) + block("Scope", "S", 3)
    root += line("1#out:1", "2#in:1") + line("2#out:1", "3#in:1")
    path = single_file(tmp_path / "m.slx", root)
    found = simulate(ModelSource(path, 0.01, Workspace({}), ()), 864_000.0)
    assert found.sample_time is None and len(found.times) < 2000
    assert found.signals[0].values[-1] == pytest.approx(864_000.0)


def test_the_survey_takes_variables_where_they_are_given(tmp_path: Path) -> None:
    """A matrix of three states fits, a guess of 1 does not."""
    root = block("Constant", "C", 1, Value="[1; 2; 3]") + block("Outport", "y", 3)
    root += block("DiscreteStateSpace", "P", 2, A="A", B="eye(3)", C="[1 1 1]", D="[0 0 0]",
                  SampleTime="0.05")  # fmt: skip
    path = single_file(
        tmp_path / "m.slx", root + line("1#out:1", "2#in:1") + line("2#out:1", "3#in:1")
    )
    assert survey_simulink(path).refusals
    given = {"A": 0.5 * np.eye(3)}
    assert not survey_simulink(path, variables=given).refusals


def test_blocks_whose_names_are_blanks_are_told_apart(tmp_path: Path) -> None:
    """By kind and number, as Simulink lets people hide a name."""
    root = ONE.format(value=1) + block("Odd", " ", 7) + block("Odd", "  ", 8)
    survey = survey_simulink(model(tmp_path / "model.slx", root))
    assert {one.path for one in survey.refusals} == {"Odd 7", "Odd 8"}
