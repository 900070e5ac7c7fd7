# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Models in Embedded Coder's conventions: every form through its Ada binding, and `bind`."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest
from typer.testing import CliRunner
from verification.support.codegen.coder_check import compare_with_direct_calls
from verification.support.codegen.coder_models import FORMS, Form, coder_files

from ravenbrick.cli.app import app
from ravenbrick.codegen import AdaBinding, ada_binding, read_binding, read_coder_model
from ravenbrick.errors import DesignError
from ravenbrick.image.controller_origin import ORIGIN_FILE

LONG = "a_controller_with_a_long_name"


def written(folder: Path, form: Form, model: str = "functional") -> Path:
    """The folder with a model and an example of a main program."""
    folder.mkdir()
    for name, text in coder_files(form, model).items():
        (folder / name).write_text(text)
    (folder / "ert_main.c").write_text("int main(void)\n{\n  return 0;\n}\n")
    return folder


@pytest.mark.parametrize("form", FORMS, ids=str)
def test_both_instances_give_the_bits_of_the_c(form: Form, tmp_path: Path) -> None:
    """On the virtual brick: own states, start values, nested gains, flags, counts."""
    model = read_coder_model(written(tmp_path / "model", form))
    (tmp_path / "work").mkdir()
    result = compare_with_direct_calls(model, tmp_path / "work")
    assert (result.compared, result.differing) == (160, 0)
    assert result.distinct > 80


def test_an_instance_without_its_own_state_is_found(tmp_path: Path) -> None:
    """The comparison can fail: a binding that does not put the state back."""
    model = read_coder_model(written(tmp_path / "model", FORMS[0]))
    (tmp_path / "work").mkdir()
    real = type(model).files_with_binding

    class Wrong(type(model)):  # type: ignore[misc]
        def files_with_binding(self, binding: AdaBinding) -> dict[str, str]:
            files = real(self, binding)
            text = files["adapted.adb"]
            files["adapted.adb"] = text.replace("      Model_Work := Work.Work;\n", "")
            return files

    wrong = Wrong(**vars(model))
    assert compare_with_direct_calls(wrong, tmp_path / "work").differing > 50


def test_a_wrong_size_does_not_compile(tmp_path: Path) -> None:
    """The C beside the binding checks what the Ada relies on."""
    files = coder_files(FORMS[2])
    others = {name: text for name, text in files.items() if name != "functional.h"}
    layout = ada_binding(files["functional.h"], AdaBinding("C"), "functional.h", others)
    text = layout["c_layout.c"]
    assert "(sizeof(D_Work_functional) == 16U) ? 1 : -1" in text
    assert "offsetof(Parameters_functional, gains.I) == 8U" in text


def test_names_that_were_cut_are_found() -> None:
    """Identifiers end after 31 characters."""
    files = coder_files(FORMS[0], LONG)
    others = {name: text for name, text in files.items() if name != f"{LONG}.h"}
    binding = ada_binding(files[f"{LONG}.h"], AdaBinding("Controller"), f"{LONG}.h", others)
    assert "ExternalOutputs_a_controller_wi" in binding["controller_layout.c"]


def test_ports_and_parameters_are_mapped_to_the_application_s() -> None:
    """Sums with factors, limits of integers, values at the start, parameters without effect."""
    files = coder_files(FORMS[3])
    others = {name: text for name, text in files.items() if name != "functional.h"}
    binding = AdaBinding(
        "Controller",
        inputs={"Input_Voltage": {"Wanted": 0.5, "Offset": -1.0}},
        outputs={"Level": {"steps": 0.25}, "Voltage": {"correctedvoltage": 2.0}},
        values={"gains.P": 1e-05},
        without_effect=("Dither",),
    )
    found = ada_binding(files["functional.h"], binding, "functional.h", others)
    body = " ".join(found["controller.adb"].split())
    assert ("Work.Inputs.Input_Voltage := Long_Float (Inputs.Wanted) * 0.5 "
            "- Long_Float (Inputs.Offset);") in body  # fmt: skip
    assert "Outputs.Level := Float (Work.Outputs.Steps) * 0.25;" in body
    assert "Outputs.Voltage := Float (Work.Outputs.Correctedvoltage * 2.0);" in body
    assert "Model_Parameters.Gains_P := 1.0e-05;" in body
    assert "Dither : Float := 0.0;" in found["controller.ads"]


def test_functions_may_have_names_of_their_own(tmp_path: Path) -> None:
    """`Controller_init` and `Controller_step` of the model functional, on the virtual brick."""
    folder = written(tmp_path / "model", FORMS[1])
    for file in folder.glob("functional.[ch]"):
        text = file.read_text().replace("functional_initialize", "Controller_init")
        file.write_text(text.replace("functional_step", "Controller_step"))
    (tmp_path / "work").mkdir()
    result = compare_with_direct_calls(read_coder_model(folder), tmp_path / "work")
    assert (result.compared, result.differing) == (160, 0)


def test_bind_writes_the_model_and_its_binding(tmp_path: Path) -> None:
    """The example of a main program is left; what is missing of the tool's headers is supplied."""
    folder = written(tmp_path / "model", FORMS[3])
    (folder / "rtwtypes.h").unlink()
    (tmp_path / "binding.toml").write_text('package = "Controller"\n')
    target = tmp_path / "generated"
    arguments = ["bind", str(folder), str(tmp_path / "binding.toml"), "--output", str(target)]
    done = CliRunner().invoke(app, [*arguments, "--json"])
    assert done.exit_code == 0, done.output
    result = json.loads(done.output)
    assert result["form"] == "reusable functions"
    assert result["supplied"] == ["rtwtypes.h"]
    assert {path.name for path in target.iterdir()} == {*result["files"], ORIGIN_FILE}
    (target / "own.c").write_text("int own;")
    assert CliRunner().invoke(app, arguments).exit_code == 0
    assert (target / "own.c").read_text() == "int own;"
    assert "ert_main.c" not in result["files"]


def _without_header(folder: Path) -> None:
    (folder / "functional.h").unlink()


def _with_another(folder: Path) -> None:
    text = (folder / "functional.h").read_text()
    (folder / "other.h").write_text(text.replace("functional", "other"))


def _including(name: str) -> Callable[[Path], None]:
    def change(folder: Path) -> None:
        text = (folder / "functional.c").read_text()
        (folder / "functional.c").write_text(f"#include {name}\n{text}")

    return change


def _replacing(old: str, new: str) -> Callable[[Path], None]:
    def change(folder: Path) -> None:
        text = (folder / "functional.h").read_text()
        assert old in text
        (folder / "functional.h").write_text(text.replace(old, new))

    return change


def _for_another_processor(folder: Path) -> None:
    text = (folder / "rtwtypes.h").read_text()
    (folder / "rtwtypes.h").write_text(text.replace("typedef short int16_T", "typedef int int16_T"))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (_without_header, "one header <model>.h .*; found: none"),
        (_with_another, "one header <model>.h .*; found: functional.h, other.h"),
        (_including('"div_s32.h"'), r"div_s32.h is included .* \(slprj/ert/_sharedutils\)"),
        (_including("<arm_math.h>"), "CMSIS .* set 'Code replacement library' to None"),
        (_including('"MW_AnalogIn.h"'), "'Hardware board' to None .* inports and outports"),
        (_including('"ext_work.h"'), "target file to ert.tlc.* 'External mode' off"),
        (_for_another_processor, "rtwtypes.h: int16_T is 'int', which has 32 bits .*>ARM 7"),
        (
            _replacing("  const char * volatile errorStatus;", "  RTWSolverInfo solverInfo;"),
            r"functional.h: the model has a solver .* 'discrete \(no continuous states\)'",
        ),
        (
            _replacing("  const char * volatile errorStatus;", "  [2];"),
            "functional.h: a field of a structure has no name",
        ),
        (
            _replacing("  const char * volatile errorStatus;", "  int16_T level[;]"),
            "functional.h: the length of 'level' must be a number",
        ),
        (
            _replacing("ExternalInputs_functional", "Levels"),
            "no structure of the model's inputs .* one inport and one outport",
        ),
        (
            _replacing("void functional_step(void)", "void functional_step(real_T arg_u)"),
            "functional_step takes 'arg_u' by itself; generate .* as structures",
        ),
        (
            _replacing("functional_step(", "functional_calculate("),
            "entry point functional_step is missing",
        ),
        (
            _replacing("functional_initialize(", "functional_begin("),
            "declared, but functional_begin, functional_step; .* one function end in _initialize",
        ),
    ],
)
def test_a_folder_that_is_no_model_is_refused(
    change: Callable[[Path], None], message: str, tmp_path: Path
) -> None:
    """In words, before anything is written."""
    folder = written(tmp_path / "model", FORMS[0])
    change(folder)
    with pytest.raises(DesignError, match=message):
        read_coder_model(folder).files_with_binding(AdaBinding("Controller"))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "package must be an Ada name"),
        ('package = "A"\nkinds = 1', "unknown field 'kinds'"),
        ('package = "A"\n[inputs]\nu = 1', "inputs.u must be a table of factors"),
        ('package = "A"\n[inputs.u]\nv = "w"', "inputs.u.v must be a number"),
        ('package = "A"\n[values]\nk = "w"', "values.k must be a number or a list"),
        ('package = "A"\n[values]\nk = [1, "w"]', "values.k must be a number or a list"),
        ('package = "A"\n[values]\nk = [1, true]', r"a list of numbers, not \[1, True\]"),
        ('package = "A', "Unterminated|Illegal|Expected"),
    ],
)
def test_a_wrong_binding_file_names_the_field(text: str, message: str, tmp_path: Path) -> None:
    """What was expected."""
    path = tmp_path / "binding.toml"
    path.write_text(text)
    with pytest.raises(DesignError, match=message):
        read_binding(path)


@pytest.mark.parametrize(
    ("binding", "message"),
    [
        (AdaBinding("C", inputs={"speed": {"Speed": 1}}), "no port among the inputs called"),
        (AdaBinding("C", values={"gains.D": 1}), "no parameter called 'gains.D'"),
        (AdaBinding("C", names={"steps": "Correctedvoltage"}), "the same name in Ada"),
    ],
)
def test_a_binding_that_does_not_fit_the_model_is_refused(
    binding: AdaBinding, message: str
) -> None:
    """With the names that there are."""
    files = coder_files(FORMS[0])
    others = {name: text for name, text in files.items() if name != "functional.h"}
    with pytest.raises(DesignError, match=message):
        ada_binding(files["functional.h"], binding, "functional.h", others)
