# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Functions and tables that some expressions need beside them in the C."""

from __future__ import annotations

from ravenbrick.codegen.c.text import c_literal, format_suffix
from ravenbrick.model import program as ir
from ravenbrick.model.number_format import Rounding

__all__ = ["helper_functions", "table_arrays"]

_NEAREST_QUOTIENT = """\
/* value / unit to the nearest whole number, halves upwards; unit is a power of two. */
static int32_T {model}_nearest_quotient(int32_T value, int32_T unit)
{{
  const int32_T lifted = value + (unit / 2);
  const uint32_T rest = (uint32_T)lifted & ((uint32_T)unit - 1U);
  return (lifted - (int32_T)rest) / unit;
}}
"""

_NEAREST_WIDE_QUOTIENT = """\
/* value / unit to the nearest whole number, halves upwards; unit is a power of two. */
static int64_T {model}_nearest_wide_quotient(int64_T value, int64_T unit)
{{
  const int64_T lifted = value + (unit / 2);
  const uint64_T rest = (uint64_T)lifted & ((uint64_T)unit - 1U);
  return (lifted - (int64_T)rest) / unit;
}}
"""

_NEAREST = """\
/* Nearest whole number, halves away from zero. */
static {real} {model}_nearest_{suffix}({real} value)
{{
  {real} whole = value;
  if ((value > -{limit}) && (value < {limit})) {{
    {real} rest;
    whole = ({real})({integer})value;
    rest = value - whole;
    if (rest >= {half}) {{
      whole += {one};
    }} else if (rest <= -{half}) {{
      whole -= {one};
    }} else {{
      /* whole is the nearest */
    }}
  }}
  return whole;
}}
"""

_LOOK_UP = """\
/* Straight lines between the points of a table, the outer ones prolonged. */
static {real} {model}_look_up_{suffix}(const {real} breakpoints[], const {real} values[],
  const {real} slopes[], uint32_T count, {real} value)
{{
  uint32_T index = 0U;
  while (((index + 1U) < count) && (value >= breakpoints[index + 1U])) {{
    index = index + 1U;
  }}
  return values[index] + (slopes[index] * (value - breakpoints[index]));
}}
"""


def _words(expression: ir.Expression) -> dict[str, str]:
    single = ir.expression_type(expression) is ir.DataType.REAL32
    return {
        "real": ir.expression_type(expression).value,
        "suffix": format_suffix(expression),
        "integer": "int32_T" if single else "int64_T",
        "limit": "8388608.0F" if single else "4503599627370496.0",
        "half": "0.5F" if single else "0.5",
        "one": "1.0F" if single else "1.0",
    }


def helper_functions(program: ir.Program) -> list[str]:
    """Lines with the static functions that the step function calls, each once."""
    found: dict[str, None] = {}
    for node in ir.expressions(program):
        if isinstance(node, ir.Rescale) and node.rounding is Rounding.NEAREST:
            helper = _NEAREST_WIDE_QUOTIENT if ir.is_wide(node.value) else _NEAREST_QUOTIENT
            found[helper.format(model=program.name)] = None
        elif isinstance(node, ir.Rounded):
            found[_NEAREST.format(model=program.name, **_words(node.value))] = None
        elif isinstance(node, ir.Table):
            found[_LOOK_UP.format(model=program.name, **_words(node.value))] = None
        elif isinstance(node, ir.Call):
            found[_twin(program, node)] = None
    return list(found)


def _twin(program: ir.Program, call: ir.Call) -> str:
    real = call.data_type.value
    given = ", ".join(f"{real} {name}" for name in call.parameters)
    body = "\n".join(f"  {line}".rstrip() for line in call.c.strip().splitlines())
    return f"static {real} {program.name}_{call.name}({given})\n{{\n{body}\n}}\n"


def table_arrays(program: ir.Program) -> list[str]:
    """Lines inside the step function with the tables' numbers."""
    lines: dict[str, None] = {}
    for node in ir.expressions(program):
        if not isinstance(node, ir.Table):
            continue
        form = ir.expression_type(node.value)
        for part, numbers in (
            ("breakpoints", node.breakpoints),
            ("values", node.values),
            ("slopes", node.slopes),
        ):
            head = f"  static const {form.value} {node.name}_{part}[{len(numbers)}] = {{"
            words = ",\n".join(f"    {c_literal(number, form)}" for number in numbers)
            lines[f"{head}\n{words}\n  }};"] = None
    return list(lines)
