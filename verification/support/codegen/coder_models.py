# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""A PI controller written as Embedded Coder would by its documented conventions, in every form."""

from __future__ import annotations

from dataclasses import dataclass

# Inputs, outputs, state, parameters, the model's own structure: names of 2012 and of today.
_TYPES = {
    "classic": ("ExternalInputs_{}", "ExternalOutputs_{}", "D_Work_{}", "Parameters_{}",
                "RT_MODEL_{}"),
    "today": ("ExtU_{}_T", "ExtY_{}_T", "DW_{}_T", "P_{}_T", "RT_MODEL_{}_T"),
}  # fmt: skip
_LONGEST = 31


@dataclass(frozen=True)
class Form:
    """Names of 2012 (`classic`) or `today`'s, C99 types or rtwtypes.h, reusable or one instance."""

    scheme: str
    c99: bool
    reusable: bool

    def __str__(self) -> str:
        words = (self.scheme, "C99" if self.c99 else "rtwtypes",
                 "reusable" if self.reusable else "one instance")  # fmt: skip
        return ", ".join(words)


FORMS = (
    Form("classic", c99=False, reusable=False),
    Form("today", c99=True, reusable=False),
    Form("classic", c99=True, reusable=True),
    Form("today", c99=False, reusable=True),
)


def coder_files(form: Form, model: str = "functional") -> dict[str, str]:
    """File texts by name: header, types, source, and rtwtypes.h unless C99 types are used."""
    names = dict(zip("UYWPM", (n.format(model)[:_LONGEST] for n in _TYPES[form.scheme]),
                     strict=True))  # fmt: skip
    real, flag, count = ("double", "bool", "int16_t") if form.c99 else (
        "real_T", "boolean_T", "int16_T")  # fmt: skip
    first = "#include <stdbool.h>\n#include <stdint.h>" if form.c99 else '#include "rtwtypes.h"'
    files = {
        f"{model}_types.h": _types(model, names, first, real),
        f"{model}.h": _header(model, names, form, (real, flag, count)),
        f"{model}.c": _source(model, names, form),
    }
    if not form.c99:
        files["rtwtypes.h"] = (
            "#ifndef RTWTYPES_H\n#define RTWTYPES_H\ntypedef double real_T;\n"
            "typedef unsigned char boolean_T;\ntypedef short int16_T;\n"
            "typedef char char_T;\n#endif\n"
        )
    return files


def _types(model: str, names: dict[str, str], first: str, real: str) -> str:
    return f"""\
#ifndef {model}_types_h_
#define {model}_types_h_
{first}
/* Gains of the controller, a bus of the model */
typedef struct {{
  {real} P;
  {real} I;
}} gains_type;
typedef struct {names["P"]}_ {names["P"]};
typedef struct tag_RTM_{model} {names["M"]};
#endif
"""


def _header(model: str, names: dict[str, str], form: Form, types: tuple[str, str, str]) -> str:
    real, flag, count = types
    links = f"  {names['P']} *defaultParam;\n  {names['U']} *inputs;\n  {names['Y']} *outputs;\n"
    links = f"  const char *errorStatus;\n{links}  {names['W']} *dwork;\n" if form.reusable else (
        "  const char * volatile errorStatus;\n")  # fmt: skip
    work = "DWork" if form.scheme == "classic" else "DW"
    variables = "" if form.reusable else (
        f"extern {names['W']} {model}_{work};\nextern {names['U']} {model}_U;\n"
        f"extern {names['Y']} {model}_Y;\nextern {names['M']} *const {model}_M;\n")  # fmt: skip
    taken = f"{names['M']} *const {model}_M" if form.reusable else "void"
    return f"""\
#ifndef RTW_HEADER_{model}_h_
#define RTW_HEADER_{model}_h_
#include "{model}_types.h"
#ifndef rtmGetErrorStatus
# define rtmGetErrorStatus(rtm) ((rtm)->errorStatus)
#endif
/* State of '<Root>' */
typedef struct {{
  {real} Integrator_DSTATE;            /* '<S1>/Integrator' */
  {count} Steps_DSTATE[2];             /* '<S1>/Steps' */
}} {names["W"]};
typedef struct {{
  {flag} hold;                         /* '<Root>/hold' */
  {real} Input_Voltage;                /* '<Root>/Input_Voltage' */
  {real} Real_Voltage;                 /* '<Root>/Real_Voltage' */
}} {names["U"]};
typedef struct {{
  {real} correctedvoltage;             /* '<Root>/correctedvoltage' */
  {count} steps;                       /* '<Root>/steps' */
}} {names["Y"]};
struct {names["P"]}_ {{
  gains_type gains;                    /* Variable: gains
                                        * Referenced by: '<S1>/Gain'
                                        */
  {real} Saturation;                   /* Variable: Saturation */
}};
struct tag_RTM_{model} {{
{links}}};
extern {names["P"]} {model}_P;
{variables}extern void {model}_initialize({taken});
extern void {model}_step({taken});
#endif
"""


def _source(model: str, names: dict[str, str], form: Form) -> str:
    if form.reusable:
        taken = f"{names['M']} *const {model}_M"
        local = "\n".join(
            f"  {names[key]} *{short} = {model}_M->{link};"
            for key, short, link in (("W", "w", "dwork"), ("U", "in", "inputs"),
                                     ("Y", "out", "outputs"), ("P", "p", "defaultParam"))
        )  # fmt: skip
        variables, start = "", f"  {model}_M->dwork->Steps_DSTATE[0] = 5;"
    else:
        work = "DWork" if form.scheme == "classic" else "DW"
        taken = "void"
        local = f"  {names['W']} *w = &{model}_{work};\n  {names['U']} *in = &{model}_U;\n" + (
            f"  {names['Y']} *out = &{model}_Y;\n  {names['P']} *p = &{model}_P;")  # fmt: skip
        variables = (f"{names['W']} {model}_{work};\n{names['U']} {model}_U;\n"
                     f"{names['Y']} {model}_Y;\nstatic {names['M']} {model}_M_;\n"
                     f"{names['M']} *const {model}_M = &{model}_M_;\n")  # fmt: skip
        start = f"  {model}_{work}.Steps_DSTATE[0] = 5;"
    return f"""\
#include "{model}.h"
{names["P"]} {model}_P = {{ {{ 0.314445, 0.032221 }}, 8.0 }};
{variables}void {model}_step({taken})
{{
{local}
  double e = in->hold ? 0.0 : in->Input_Voltage - in->Real_Voltage;
  double u = p->gains.P * e + w->Integrator_DSTATE;
  double y = u;
  if (y > p->Saturation) {{
    y = p->Saturation;
  }} else if (y < -p->Saturation) {{
    y = -p->Saturation;
  }}
  w->Integrator_DSTATE += p->gains.I * e + 0.10810811 * (y - u);
  w->Steps_DSTATE[0]++;
  out->correctedvoltage = y;
  out->steps = w->Steps_DSTATE[0];
}}
void {model}_initialize({taken})
{{
{start}
}}
"""
