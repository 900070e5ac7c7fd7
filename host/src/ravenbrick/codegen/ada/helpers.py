# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Functions and tables that some expressions need beside them in the Ada."""

from __future__ import annotations

from ravenbrick.codegen.ada.text import (
    ada_literal,
    ada_name,
    ada_type,
    nearest_name,
    wrapped,
)
from ravenbrick.errors import DesignError
from ravenbrick.model import program as ir
from ravenbrick.model.number_format import Rounding

__all__ = ["ada_helpers", "needs_interfaces"]

_NEAREST_QUOTIENT = """\
   --  Value / Unit to the nearest whole number, halves upwards; Unit is a power of two
   function Nearest_Quotient (Value, Unit : Integer_32) return Integer_32 with
     Pre  => Unit > 0 and then Value <= Integer_32'Last - Unit / 2,
     Post => Nearest_Quotient'Result * Unit in Value - Unit / 2 + Unit mod 2 .. Value + Unit / 2;

   function Nearest_Quotient (Value, Unit : Integer_32) return Integer_32 is
      Lifted : constant Integer_32 := Value + Unit / 2;
      Rest   : constant Unsigned_32 := Unsigned_32'Mod (Lifted) and (Unsigned_32 (Unit) - 1);
   begin
      return (Lifted - Integer_32 (Rest)) / Unit;
   end Nearest_Quotient;
"""

_NEAREST = """\
   --  Nearest whole number, halves away from zero
   function Nearest_{suffix} (Value : {real}) return {real} with
     Post => (if abs Value < {limit}
              then abs (Nearest_{suffix}'Result - Value) <= 0.5
              else Nearest_{suffix}'Result = Value
                or else Value /= Value);

   function Nearest_{suffix} (Value : {real}) return {real} is
      Whole : {real};
      Rest  : {real};
   begin
      if not (Value > -{limit} and then Value < {limit}) then
         return Value;
      end if;
      Whole := {real} ({integer} ({real}'Truncation (Value)));
      Rest := Value - Whole;
      if Rest >= 0.5 then
         return Whole + 1.0;
      elsif Rest <= -0.5 then
         return Whole - 1.0;
      else
         return Whole;
      end if;
   end Nearest_{suffix};
"""

_LOOK_UP = """\
   type {suffix}_Array is array (Natural range <>) of {real};

   --  Straight lines between the points of a table, the outer ones prolonged
   function Look_Up_{suffix}
     (Breakpoints, Values, Slopes : {suffix}_Array; Value : {real}) return {real}
   with
     Pre => Breakpoints'Length > 0
            and then Values'First = Breakpoints'First and then Values'Last = Breakpoints'Last
            and then Slopes'First = Breakpoints'First and then Slopes'Last = Breakpoints'Last;

   function Look_Up_{suffix}
     (Breakpoints, Values, Slopes : {suffix}_Array; Value : {real}) return {real}
   is
      Index : Natural := Breakpoints'First;
   begin
      while Index < Breakpoints'Last and then Value >= Breakpoints (Index + 1) loop
         Index := Index + 1;
      end loop;
      return Values (Index) + Slopes (Index) * (Value - Breakpoints (Index));
   end Look_Up_{suffix};
"""


def _words(expression: ir.Expression) -> dict[str, str]:
    form = ir.expression_type(expression)
    single = form is ir.DataType.REAL32
    return {
        "real": ada_type(form),
        "suffix": nearest_name(form),
        "integer": "Integer" if single else "Long_Long_Integer",
        "limit": "8_388_608.0" if single else "4_503_599_627_370_496.0",
    }


def needs_interfaces(program: ir.Program) -> bool:
    """Whether the body works on the integers behind fixed-point values."""
    return any(isinstance(node, ir.Rescale) for node in ir.expressions(program))


def ada_helpers(program: ir.Program) -> list[str]:
    """Declarations before the step procedure, each once, with the tables' numbers."""
    found: dict[str, None] = {}
    tables: dict[str, None] = {}
    for node in ir.expressions(program):
        if isinstance(node, ir.Rescale) and node.rounding is Rounding.NEAREST:
            found[_NEAREST_QUOTIENT] = None
        elif isinstance(node, ir.Rounded):
            found[_NEAREST.format(**_words(node.value))] = None
        elif isinstance(node, ir.Table):
            found[_LOOK_UP.format(**_words(node.value))] = None
            for text in _arrays(node):
                tables[text] = None
        elif isinstance(node, ir.Call):
            found[_twin(node)] = None
    return [*found, *tables]


def _twin(call: ir.Call) -> str:
    real, name = ada_type(call.data_type), ada_name(call.name)
    if not call.ada:
        raise DesignError(
            f"block '{call.name}' has no Ada twin; give its function's body in Ada as `ada`"
        )
    given = ", ".join(map(ada_name, call.parameters))
    body = "\n".join(f"      {line}".rstrip() for line in call.ada.strip().splitlines())
    head = f"function {name} ({given} : {real}) return {real}"
    return f"   {head};\n\n   {head} is\n   begin\n{body}\n   end {name};\n"


def _arrays(table: ir.Table) -> list[str]:
    form = ir.expression_type(table.value)
    texts = []
    for part, numbers in (
        ("Breakpoints", table.breakpoints),
        ("Values", table.values),
        ("Slopes", table.slopes),
    ):
        values = ", ".join(
            f"{index} => {ada_literal(number, form)}" for index, number in enumerate(numbers)
        )
        kind = f"{nearest_name(form)}_Array"
        head = f"   {ada_name(table.name)}_{part} : constant {kind} :="
        texts.append("\n".join([head, *wrapped(f"({values});", 5), ""]))
    return texts
