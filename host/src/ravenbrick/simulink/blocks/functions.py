# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Exponential, logarithm and power, for targets without a mathematical library."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from ravenbrick.model import Abs, CustomFunction, RoundingFunction
from ravenbrick.simulink.builder import Builder
from ravenbrick.simulink.signals import Wire

__all__ = ["exponential", "logarithm", "power"]

_F = np.float32
_MOST = 88.0
_LEAST = 1.17549435e-38
# exp(r) for |r| <= ln(2)/2 by its Taylor series; the error is below the rounding.
_EXP = (1.0 / 720, 1.0 / 120, 1.0 / 24, 1.0 / 6, 0.5, 1.0, 1.0)
# ln(2) in two parts: the first has so few bits that its products with exponents are exact.
_LN2_HIGH, _LN2_LOW = 0.693359375, -2.12194440e-4
# atanh(s)/s in s*s, |s| <= 0.172.
_ATANH = (1.0 / 9, 1.0 / 7, 0.2, 1.0 / 3, 1.0)


def _polynomial(coefficients: tuple[float, ...], at: np.float32) -> np.float32:
    total = _F(coefficients[0])
    for one in coefficients[1:]:
        total = total * at + _F(one)
    return total


def _exp(a: Any) -> float:
    """Single precision as the C has it; double precision, in simulations, from the library."""
    if not isinstance(a, np.float32):
        return float(np.exp(np.float64(a)))
    a = min(max(a, _F(-_MOST)), _F(_MOST))
    scaled = a * _F(1 / math.log(2))
    whole = int(scaled + (_F(0.5) if scaled >= 0 else _F(-0.5)))
    rest = (a - _F(whole) * _F(_LN2_HIGH)) - _F(whole) * _F(_LN2_LOW)
    found = _polynomial(_EXP, rest)
    for _ in range(abs(whole)):
        found *= _F(2.0) if whole > 0 else _F(0.5)
    return float(found)


def _log(a: Any) -> float:
    """Likewise; what is not positive counts as the smallest normal number."""
    if not isinstance(a, np.float32):
        return float(np.log(max(np.float64(a), _LEAST)))
    rest, whole = max(a, _F(_LEAST)), 0
    while rest > _F(math.sqrt(2)):
        rest, whole = rest * _F(0.5), whole + 1
    while rest < _F(math.sqrt(0.5)):
        rest, whole = rest * _F(2.0), whole - 1
    share = (rest - _F(1.0)) / (rest + _F(1.0))
    series = _polynomial(_ATANH, share * share)
    low = _F(2.0) * share * series + _F(whole) * _F(_LN2_LOW)
    return float(_F(whole) * _F(_LN2_HIGH) + low)


def _number(value: float) -> str:
    text = np.format_float_positional(_F(value), unique=True, trim="0")
    return text if len(text) <= 17 else np.format_float_scientific(_F(value), unique=True, trim="0")


def _horner(coefficients: tuple[float, ...], at: str, c: bool) -> str:
    """One assignment per coefficient, to `found`."""
    sign, suffix = ("=", "F") if c else (":=", "")
    lines = [f"found {sign} {_number(coefficients[0])}{suffix};"]
    lines += [f"found {sign} (found * {at}) + {_number(one)}{suffix};" for one in coefficients[1:]]
    return "\n".join(lines)


_EXP_C = f"""\
real32_T limited = a;
real32_T scaled;
real32_T rest;
real32_T found;
int32_T whole;
if (a > {_MOST}F) {{
  limited = {_MOST}F;
}} else if (a < -{_MOST}F) {{
  limited = -{_MOST}F;
}} else {{
  /* within the range */
}}
scaled = limited * {_number(1 / math.log(2))}F;
whole = (int32_T)(scaled + ((scaled >= 0.0F) ? 0.5F : -0.5F));
rest = (limited - ((real32_T)whole * {_number(_LN2_HIGH)}F))
  - ((real32_T)whole * ({_number(_LN2_LOW)}F));
{_horner(_EXP, "rest", True)}
for (; whole > 0; whole--) {{
  found = found * 2.0F;
}}
for (; whole < 0; whole++) {{
  found = found * 0.5F;
}}
return found;"""

_LOG_C = f"""\
real32_T rest = (a > {_number(_LEAST)}F) ? a : {_number(_LEAST)}F;
real32_T share;
real32_T square;
real32_T found;
int32_T whole = 0;
while (rest > {_number(math.sqrt(2))}F) {{
  rest = rest * 0.5F;
  whole = whole + 1;
}}
while (rest < {_number(math.sqrt(0.5))}F) {{
  rest = rest * 2.0F;
  whole = whole - 1;
}}
share = (rest - 1.0F) / (rest + 1.0F);
square = share * share;
{_horner(_ATANH, "square", True)}
found = (2.0F * share * found) + ((real32_T)whole * ({_number(_LN2_LOW)}F));
return ((real32_T)whole * {_number(_LN2_HIGH)}F) + found;"""

_EXP_ADA = f"""\
declare
   Limited : constant Float := Float'Max (-{_MOST}, Float'Min (A, {_MOST}));
   Scaled : constant Float := Limited * {_number(1 / math.log(2))};
   Whole : constant Integer :=
     Integer (Float'Truncation (Scaled + (if Scaled >= 0.0 then 0.5 else -0.5)));
   Rest : constant Float := (Limited - Float (Whole) * {_number(_LN2_HIGH)})
     - Float (Whole) * ({_number(_LN2_LOW)});
   Found : Float;
begin
{_horner(_EXP, "Rest", False).replace("found", "Found")}
   for Step in 1 .. abs Whole loop
      Found := Found * (if Whole > 0 then 2.0 else 0.5);
   end loop;
   return Found;
end;"""

_LOG_ADA = f"""\
declare
   Rest : Float := Float'Max (A, {_number(_LEAST).replace("e", "E")});
   Whole : Integer := 0;
   Share, Square, Found : Float;
begin
   while Rest > {_number(math.sqrt(2))} loop
      Rest := Rest * 0.5;
      Whole := Whole + 1;
   end loop;
   while Rest < {_number(math.sqrt(0.5))} loop
      Rest := Rest * 2.0;
      Whole := Whole - 1;
   end loop;
   Share := (Rest - 1.0) / (Rest + 1.0);
   Square := Share * Share;
{_horner(_ATANH, "Square", False).replace("found", "Found")}
   Found := (2.0 * Share * Found) + Float (Whole) * ({_number(_LN2_LOW)});
   return Float (Whole) * {_number(_LN2_HIGH)} + Found;
end;"""


def exponential(b: Builder, wire: Wire) -> Wire:
    """exp(u), its argument limited to 88 in size."""
    return b.add(_function(_exp, _EXP_C, _EXP_ADA), wire, ending="_exp")


def logarithm(b: Builder, wire: Wire) -> Wire:
    """ln(u); what is not positive counts as the smallest normal number."""
    return b.add(_function(_log, _LOG_C, _LOG_ADA), wire, ending="_log")


def power(b: Builder, base: Wire, exponent: Wire) -> Wire:
    """u^v by logarithms; of a negative base whole exponents count, others give 0."""
    size = b.add(Abs("B"), base, ending="_size")
    found = exponential(b, b.product(exponent, logarithm(b, size)))
    zero, one = b.constant(0.0), b.constant(1.0)
    floor = RoundingFunction("B", function="floor")
    half = b.scaled(0.5, exponent)
    odd = b.compare(b.add(floor, half, ending="_half"), "~=", half)
    whole = b.compare(b.add(floor, exponent, ending="_whole"), "==", exponent)
    turned = b.choose(odd, b.scaled(-1.0, found), found)
    negative = b.choose(whole, turned, zero)
    signed = b.choose(b.compare(base, "<", 0.0), negative, found)
    nothing = b.choose(b.compare(exponent, "==", 0.0), one, zero)
    return b.choose(b.compare(base, "==", 0.0), nothing, signed)


def _function(function: Callable[[float], float], c: str, ada: str) -> CustomFunction:
    return CustomFunction("B", function=function, c=c, ada=ada)
