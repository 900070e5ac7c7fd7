# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Ada bindings from C headers: ours, and Embedded Coder's under both naming schemes."""

from __future__ import annotations

from pathlib import Path

import pytest
from verification.support.codegen.c_build import ada_object
from verification.support.codegen.coder_models import FORMS, coder_files
from verification.support.codegen.paper_pi import paper_pi

from ravenbrick.codegen import AdaBinding, ada_binding, generate_c, read_header
from ravenbrick.errors import DesignError

# What Embedded Coder writes for a model with two inports, one outport and one state, by its
# documented conventions; {e} is the scheme of 2012 or today's.
SCHEMES = {
    "classic": ("ExternalInputs_functional", "ExternalOutputs_functional", "D_Work_functional",
                "Parameters_functional", "functional_DWork"),
    "shortened": ("ExtU_functional_T", "ExtY_functional_T", "DW_functional_T", "P_functional_T",
                  "functional_DW"),
}  # fmt: skip

WORK = SCHEMES["classic"][2]


def coder_header(scheme: str, real: str = "real_T") -> str:
    """A header in Embedded Coder's layout."""
    inputs, outputs, work, parameters, variable = SCHEMES[scheme]
    return f"""\
#ifndef RTW_HEADER_functional_h_
#define RTW_HEADER_functional_h_
#include "rtwtypes.h"
/* Block states (auto storage) for system '<Root>' */
typedef struct {{
  {real} DiscreteTimeIntegrator_DSTATE; /* '<S1>/Discrete-Time Integrator' */
}} {work};
/* External inputs (root inport signals with auto storage) */
typedef struct {{
  {real} Input_Voltage;                 /* '<Root>/Input_Voltage' */
  {real} Real_Voltage;                  /* '<Root>/Real_Voltage' */
}} {inputs};
typedef struct {{
  {real} correctedvoltage;              /* '<Root>/correctedvoltage' */
}} {outputs};
/* Parameters (auto storage) */
struct {parameters}_ {{
  {real} Saturation;                    /* Variable: Saturation */
}};
extern {parameters} functional_P;
extern {work} {variable};
extern {inputs} functional_U;
extern {outputs} functional_Y;
extern void functional_initialize(void);
extern void functional_step(void);
extern void functional_terminate(void);
#endif
"""


def compiled(files: dict[str, str], folder: Path) -> None:
    """The package compiles with all warnings and style checks as errors."""
    for name, text in files.items():
        (folder / name).write_text(text)
    unit = next((name for name in files if name.endswith(".adb")), next(iter(files)))
    ada_object(folder, unit, checks=False)


def test_our_header_becomes_an_import_without_a_body(tmp_path: Path) -> None:
    """Parameters, entry points and sizes by the rules of C."""
    files = ada_binding(generate_c(paper_pi()).files["functional.h"], AdaBinding("Controller"))
    text = files["controller.ads"]
    assert 'External_Name => "functional_step_instance"' in text
    assert 'External_Name => "functional_P"' in text
    assert "Convention => C, Size => 128" in text
    assert list(files) == ["controller.ads"]
    compiled(files, tmp_path)


@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("real", ["real_T", "real32_T", "double", "float", "int16_T"])
def test_both_schemes_become_the_same_specification(scheme: str, real: str, tmp_path: Path) -> None:
    """The application's part does not depend on the scheme; the package compiles."""
    files = ada_binding(coder_header(scheme, real), AdaBinding("Controller"))
    other = ada_binding(coder_header("classic", real), AdaBinding("Controller"))
    public = [text["controller.ads"].partition("private")[0] for text in (files, other)]
    assert public[0] == public[1]
    compiled(files, tmp_path)


def test_application_types_are_converted_in_the_body(tmp_path: Path) -> None:
    """Double precision inside, the application's voltages outside."""
    (tmp_path / "quantities.ads").write_text(
        "package Quantities is\n   type Volts is new Float;\nend Quantities;\n"
    )
    names = ("Input_Voltage", "Real_Voltage", "correctedvoltage", "Saturation")
    binding = AdaBinding("Controller", types=dict.fromkeys(names, "Quantities.Volts"))
    files = ada_binding(coder_header("shortened"), binding)
    assert (
        "Model_Inputs.Input_Voltage := Long_Float (Inputs.Input_Voltage);"
        in (files["controller.adb"])
    )
    compiled(files, tmp_path)


def test_a_model_without_states_leaves_its_work_area_alone(tmp_path: Path) -> None:
    """Neither operation reads it, which compiles without a warning."""
    text = coder_header("classic").replace("extern D_Work_functional functional_DWork;\n", "")
    files = ada_binding(text, AdaBinding("Controller"))
    assert files["controller.adb"].count("pragma Unreferenced (Work);") == 2
    compiled(files, tmp_path)


def test_values_of_an_array_are_set_whole(tmp_path: Path) -> None:
    """Seven taps in rows of six, a scalar beside them; another number of values is refused."""
    text = coder_header("classic").replace(
        "  real_T Saturation;", "  real_T Taps[7];\n  real_T Saturation;"
    )
    taps = [1, 2.5, -3, 0, 4, 5, 6e-7]
    binding = AdaBinding("Controller", values={"Taps": taps, "Saturation": 8})
    files = ada_binding(text, binding)
    body = " ".join(files["controller.adb"].split())
    assert "Model_Parameters.Taps := (1.0, 2.5, -3.0, 0.0, 4.0, 5.0, 6.0e-07);" in body
    assert "Model_Parameters.Saturation := 8.0;" in body
    compiled(files, tmp_path)
    for name, value, count in (
        ("Taps", taps[:6], "7"),
        ("Taps", 1, "7"),
        ("Saturation", [8], "one"),
    ):
        with pytest.raises(DesignError, match=f"parameter '{name}' needs {count} numbers"):
            ada_binding(text, AdaBinding("Controller", values={name: value}))


def test_of_two_types_for_the_work_the_model_s_own_structure_says_which() -> None:
    """A subsystem that bears the model's name has a type of its own, by the other scheme."""
    files = coder_files(FORMS[2])
    text = files.pop("functional.h")
    place = "/* State of '<Root>' */"
    assert place in text and read_header(text, "functional.h", files).types["work"] == WORK
    other = "typedef struct { double own; } DW_functional_T;"
    found = read_header(text.replace(place, f"{other}\n{place}"), "functional.h", files)
    assert found.types["work"] == WORK


def test_structures_are_found_under_either_name() -> None:
    """Roles, variables and sizes."""
    for scheme, names in SCHEMES.items():
        header = read_header(coder_header(scheme))
        assert header.types["inputs"] == names[0]
        assert header.symbols["work"] == names[4]
        assert header.size_bits("inputs") == 128
        assert not header.reentrant


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("int x;", "no entry point <model>_initialize"),
        ("extern void m_initialize(void);", "no structure of the model's inputs"),
        (
            "typedef struct tag_RTM RT_MODEL;\nextern void m_initialize(RT_MODEL *const rtM);",
            "takes a RT_MODEL, which is not declared|no structure of the model's inputs",
        ),
        (
            coder_header("classic").replace("real_T Real_Voltage", "Bus_T Real_Voltage"),
            "field 'Real_Voltage' of ExternalInputs_functional has the type Bus_T",
        ),
        (
            coder_header("classic").replace("step(void)", "step(RT_MODEL *const m)"),
            "takes a RT_MODEL, which is not declared",
        ),
        (
            coder_header("classic").replace("step(void)", "step(real_T In1)"),
            "takes 'In1' by itself",
        ),
        (
            coder_header("classic").replace("functional_step(void)", "functional_step0(void)"),
            "entry point functional_step is missing",
        ),
        (
            coder_header("classic").replace("real_T Real_Voltage;", "void *Real_Voltage;"),
            "has a field that is neither a number nor an array",
        ),
        (
            coder_header("classic").replace("real_T Real_V", "ExternalInputs_functional Real_V"),
            "header: ExternalInputs_functional: field 'Real_Voltage' .* a structure holds itself",
        ),
    ],
)
def test_what_cannot_be_bound_is_said(text: str, message: str) -> None:
    """Nothing is guessed."""
    with pytest.raises(DesignError, match=message):
        ada_binding(text, AdaBinding("Controller"))
