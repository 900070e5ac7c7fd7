# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""An Ada package between an application and a model that Embedded Coder generated."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from ravenbrick import __version__
from ravenbrick.codegen.ada.interface import RECORDS, STEP, AdaBinding, Interface, imported
from ravenbrick.codegen.ada.text import ada_name
from ravenbrick.codegen.c.header import KEPT_ROLES, CField, ModelHeader
from ravenbrick.errors import DesignError

__all__ = ["Adapter"]

_LIMITS = {
    "Interfaces.Integer_8": (-(2**7), 2**7 - 1),
    "Interfaces.Unsigned_8": (0, 2**8 - 1),
    "Interfaces.Integer_16": (-(2**15), 2**15 - 1),
    "Interfaces.Unsigned_16": (0, 2**16 - 1),
    "Interfaces.Integer_32": (-(2**31), 2**31 - 1),
    "Interfaces.Unsigned_32": (0, 2**32 - 1),
}
_ARRAY_VALUES_PER_LINE = 6


class Adapter(Interface):
    """Specification, body, and a check of the structures' layout."""

    def __init__(self, model: ModelHeader, binding: AdaBinding, file: str) -> None:
        super().__init__(model, binding)
        self._file = file
        self._check()
        self._shared = [] if model.reusable else self._kept()

    def _check(self) -> None:
        model = self.model
        for word in ("initialize", "step"):
            if word not in model.entries:
                raise DesignError(
                    f"the model's entry point {model.model}_{word} is missing; generate the model "
                    "with one step function for its one rate"
                )
        self.check_names(("inputs", "outputs", "parameters"))
        for role in ("inputs", "outputs"):
            names = {one.name for one in model.fields[role]}
            used = set(self.binding.inputs)
            if role == "outputs":
                used = {port for ports in self.binding.outputs.values() for port in ports}
            _check_known(used, names, f"port among the {role}")
        known = {one.name for one in model.fields.get("parameters", ())}
        _check_known(self.binding.values, known, "parameter")
        if model.reusable:
            return
        for role in ("inputs", "outputs"):
            if role not in model.symbols:
                raise DesignError(f"the header declares no variable of type {model.types[role]}")

    def _kept(self) -> list[str]:
        return [r for r in KEPT_ROLES if self.model.sizes.get(r) and r in self.model.symbols]

    def files(self) -> dict[str, str]:
        """File text by file name."""
        package, spec = self.binding.package.lower(), self._spec()
        return {
            f"{package}.ads": self.file("package", spec),
            f"{package}.adb": self.file("package body", self._body(), spec),
            f"{package}_layout.c": self._layout(),
        }

    # What the application sees

    def _spec(self) -> list[str]:
        lines = self.arrays(("inputs", "outputs", "parameters"))
        lines += self._seen("inputs", self._application_inputs())
        lines += self._seen("outputs", {name: name for name in self.binding.outputs})
        if self._has_parameters():
            extra = {name: name for name in self.binding.without_effect}
            lines += self._seen("parameters", extra)
            lines += [f"   Parameters : {RECORDS['parameters']};", ""]
        lines += ["   type Work_Area is limited private;", ""]
        lines += ["   procedure Initialize (Work : in out Work_Area);", ""]
        lines += [
            *STEP[:-1],
            f"{STEP[-1]};",
            "   --  One sample of one instance",
            "",
            "private",
            "",
        ]
        return [*lines, *(self._instance() if self.model.reusable else self._kept_state())]

    def _application_inputs(self) -> dict[str, str]:
        """Fields of the application by the name that the binding gives them."""
        fields: dict[str, str] = {}
        for sources in self.binding.inputs.values():
            fields |= {name: name for name in sources}
        return fields

    def _has_parameters(self) -> bool:
        return bool(self.model.fields.get("parameters") or self.binding.without_effect)

    def _seen(self, role: str, mapped: Mapping[str, str]) -> list[str]:
        """A record of the application: mapped fields, or those of the model as they are."""
        lines = [f"   type {RECORDS[role]} is record"]
        plain = role == "parameters" or not mapped
        for one in self.model.fields.get(role, ()) if plain else ():
            lines += self.field_lines(one, self.application_type(one))
        for name in mapped:
            start = " := 0.0" if role == "parameters" else ""
            lines.append(f"      {ada_name(name)} : {self._mapped_type(name)}{start};")
            if role == "parameters":
                lines.append("      --  without effect")
        if lines[-1].endswith("is record"):
            lines.append("      null;")
        return [*lines, "   end record;", ""]

    def _mapped_type(self, name: str) -> str:
        return self.binding.types.get(name, "Float")

    def _kept_state(self) -> list[str]:
        """The private part with a single instance: a copy of all that the model keeps."""
        lines, parts = [], []
        for role in self._shared:
            lines += self._bytes(role)
            parts.append(f"      {role.capitalize()} : {role.capitalize()}_Data;")
        return [*lines, "   type Work_Area is record", *(parts or ["      null;"]),
                "   end record;", ""]  # fmt: skip

    def _bytes(self, role: str) -> list[str]:
        size, name = self.model.sizes[role], f"{role.capitalize()}_Data"
        return [
            f"   type {name} is array (1 .. {size}) of Interfaces.Unsigned_8 with",
            f"     Convention => C, Alignment => {self.model.alignments[role]};",
            "",
        ]

    def _instance(self) -> list[str]:
        """The private part with reusable functions: the model's data, one of each."""
        model = self.model
        lines, parts = [], []
        for role in ("inputs", "outputs"):
            lines += self._c_record(role)
            parts.append(f"      {role.capitalize()} : aliased {role.capitalize()}_Data;")
        for role in self._owned():
            lines += self._bytes(role)
            parts.append(f"      {role.capitalize()} : aliased {role.capitalize()}_Data;")
        if "model" in model.types:
            words = max(model.sizes["model"] // 4, 1)
            lines += [
                f"   type Model_Data is array (0 .. {words - 1}) of System.Address with",
                f"     Convention => C, Alignment => {model.alignments['model']};",
                "   --  Also holds numbers; all are zero at the start",
                "",
            ]
            parts.append("      Model : aliased Model_Data;")
        return [*lines, "   type Work_Area is limited record", *parts, "   end record;", ""]

    def _owned(self) -> list[str]:
        arguments = {a for entry in self.model.entries.values() for a in entry.arguments}
        needed = arguments | set(self.model.links)
        return [r for r in KEPT_ROLES if self.model.sizes.get(r) and r in needed]

    def _c_record(self, role: str) -> list[str]:
        """A record as the C lays it out."""
        name = f"{role.capitalize()}_Data"
        lines, places = [f"   type {name} is record"], []
        for one in self.model.fields[role]:
            kind = self.c_type(one)
            if one.length is not None:
                kind = f"{kind.rpartition('.')[2]}_Values_{one.length}"
            lines.append(f"      {self.name(one)} : {kind};")
            last = 8 * one.size_bytes * (one.length or 1) - 1
            places.append(f"      {self.name(one)} at {one.offset_bytes} range 0 .. {last};")
        if not places:
            lines.append("      null;")
        size, alignment = self.model.size_bits(role), self.model.alignments[role]
        lines += [f"   end record with Convention => C, Size => {size}, Alignment => {alignment};"]
        if places:
            lines += [f"   for {name} use record", *places, "   end record;"]
        return [*lines, ""]

    # What it does

    def _body(self) -> list[str]:
        lines = [] if self.model.reusable else self._c_record("inputs") + self._c_record("outputs")
        lines += self._variables()
        for word in ("initialize", "step"):
            lines += self._entry(word)
        lines += ["   procedure Initialize (Work : in out Work_Area) is", "   begin"]
        lines += self._start() if self.model.reusable else self._clear()
        lines += [self._call("initialize")]
        lines += [f"      Work.{_data(role)} := {_variable(role)};" for role in self._shared]
        lines += self._set_values() + self._parameters(inward=False)
        if not self._initialize_uses_work():
            lines += ["      pragma Unreferenced (Work);"]
        lines += ["   end Initialize;", "", *STEP, "   is", "   begin"]
        lines += [f"      {_variable(role)} := Work.{_data(role)};" for role in self._shared]
        lines += self._inputs() + self._parameters(inward=True)
        lines += [self._call("step"), *self._outputs()]
        lines += [f"      Work.{_data(role)} := {_variable(role)};" for role in self._shared]
        if not self._initialize_uses_work():
            lines += ["      pragma Unreferenced (Work);"]
        return [*lines, "   end Step;", ""]

    def _initialize_uses_work(self) -> bool:
        return self.model.reusable or bool(self._shared)

    def _variables(self) -> list[str]:
        """The model's variables, and its parameters if nobody else holds them."""
        model, lines = self.model, []
        for role in () if model.reusable else ("inputs", "outputs"):
            kind = f"{role.capitalize()}_Data"
            lines += [f"   {_variable(role)} : {kind} with", imported(model.symbols[role]), ""]
        for role in self._shared:
            kind = f"{role.capitalize()}_Data"
            lines += [f"   {_variable(role)} : {kind} with", imported(model.symbols[role]), ""]
        if model.fields.get("parameters"):
            lines += self._c_record("parameters")
            head = f"   {_variable('parameters')} : Parameters_Data"
            symbol = model.symbols.get("parameters")
            lines += [f"{head} with", imported(symbol), ""] if symbol else [f"{head};", ""]
        return lines

    def _entry(self, word: str) -> list[str]:
        entry = self.model.entries[word]
        names = [
            "First_Time : Interfaces.Unsigned_8" if role == "first_time"
            else f"{role.capitalize()} : System.Address"
            for role in entry.arguments
        ]  # fmt: skip
        taken = f" ({'; '.join(names)})" if names else ""
        return [f"   procedure Model_{word.capitalize()}{taken} with", imported(entry.name), ""]

    def _call(self, word: str) -> str:
        values = []
        for role in self.model.entries[word].arguments:
            own = f"Work.{_data(role)}" if self.model.reusable else _variable(role)
            own = _variable(role) if role == "parameters" else own
            values.append("1" if role == "first_time" else f"{own}'Address")
        given = f" ({', '.join(values)})" if values else ""
        return f"      Model_{word.capitalize()}{given};"

    def _clear(self) -> list[str]:
        """The model expects to start from zeros and sets what starts otherwise."""
        lines = [f"      {_variable(role)} := (others => 0);" for role in self._shared]
        return [*lines, *self._zero("outputs", _variable("outputs"))]

    def _zero(self, role: str, variable: str) -> list[str]:
        lines = []
        for one in self.model.fields[role]:
            zero = "0.0" if "Float" in self.c_type(one) else "0"
            zero = zero if one.length is None else f"(others => {zero})"
            lines.append(f"      {variable}.{self.name(one)} := {zero};")
        return lines

    def _start(self) -> list[str]:
        """All data zero and linked."""
        lines = [f"      Work.{_data(role)} := (others => 0);" for role in self._owned()]
        lines += self._zero("inputs", "Work.Inputs") + self._zero("outputs", "Work.Outputs")
        if "model" in self.model.types:
            lines.append("      Work.Model := (others => System.Null_Address);")
        for role, offset in self.model.links.items():
            own = _variable(role) if role == "parameters" else f"Work.{_data(role)}"
            if role in ("inputs", "outputs", "parameters") or role in self._owned():
                lines.append(f"      Work.Model ({offset // 4}) := {own}'Address;")
        return lines

    def _place(self, role: str) -> str:
        return f"Work.{role.capitalize()}" if self.model.reusable else _variable(role)

    def _inputs(self) -> list[str]:
        lines, place = [], self._place("inputs")
        for one in self.model.fields["inputs"]:
            target = f"{place}.{self.name(one)}"
            if self.binding.inputs:
                sources = self.binding.inputs.get(one.name)
                if sources is not None:
                    terms = [(f"Inputs.{ada_name(n)}", self._mapped_type(n), k)
                             for n, k in sources.items()]  # fmt: skip
                    lines += _assigned(target, self.c_type(one), terms)
                continue
            kinds = self.application_type(one), self.c_type(one)
            lines.append(f"      {target} := {_converted(f'Inputs.{self.name(one)}', *kinds)};")
        return lines

    def _outputs(self) -> list[str]:
        lines, place = [], self._place("outputs")
        ports = {one.name: one for one in self.model.fields["outputs"]}
        for name, sources in self.binding.outputs.items():
            terms = [(f"{place}.{self.name(ports[p])}", self.c_type(ports[p]), k)
                     for p, k in sources.items()]  # fmt: skip
            lines += _assigned(f"Outputs.{ada_name(name)}", self._mapped_type(name), terms)
        for one in () if self.binding.outputs else ports.values():
            kinds = self.c_type(one), self.application_type(one)
            value = _converted(f"{place}.{self.name(one)}", *kinds)
            lines.append(f"      Outputs.{self.name(one)} := {value};")
        return lines

    def _parameters(self, *, inward: bool) -> list[str]:
        lines = []
        for one in self.model.fields.get("parameters", ()):
            own, inner = f"Parameters.{self.name(one)}", f"Model_Parameters.{self.name(one)}"
            kinds = self.application_type(one), self.c_type(one)
            if inward:
                lines.append(f"      {inner} := {_converted(own, *kinds)};")
            else:
                lines.append(f"      {own} := {_converted(inner, *kinds[::-1])};")
        return lines

    def _set_values(self) -> list[str]:
        lines = []
        known = {one.name: one for one in self.model.fields.get("parameters", ())}
        for name, value in self.binding.values.items():
            one = known[name]
            target = f"      Model_Parameters.{self.name(one)} :="
            if one.length is None and not isinstance(value, Sequence):
                lines.append(f"{target} {self._number(one, value)};")
                continue
            if not isinstance(value, Sequence) or len(value) != one.length:
                raise DesignError(f"parameter '{name}' needs {one.length or 'one'} numbers")
            numbers = [self._number(one, item) for item in value]
            rows = [
                ", ".join(numbers[at : at + _ARRAY_VALUES_PER_LINE])
                for at in range(0, len(numbers), _ARRAY_VALUES_PER_LINE)
            ]
            lines += [target, f"        ({f',{chr(10)}         '.join(rows)});"]
        return lines

    def _number(self, one: CField, value: float) -> str:
        if "Float" in self.c_type(one):
            return _literal(value)
        if value != int(value):
            raise DesignError(
                f"parameter '{one.name}' is {one.c_type}: {value} is not a whole number"
            )
        return str(int(value))

    def _layout(self) -> str:
        """C that compiles only if sizes and offsets are those of the Ada."""
        model = self.model
        lines = [
            "/* SPDX-FileCopyrightText: 2026 Ravenbrick contributors */",
            "/* SPDX-License-Identifier: Apache-2.0 */",
            f"/* Generated by ravenbrick {__version__}: do not edit. Sizes and offsets that",
            f"   {self.binding.package.lower()}.adb relies on. */",
            "#include <stddef.h>",
            f'#include "{self._file}"',
            "",
        ]
        for role in model.types:
            kind = model.types[role]
            if role == "model" and not model.reusable:
                continue
            lines.append(f"typedef char {role}_has_{model.sizes[role]}[")
            lines.append(f"  (sizeof({kind}) == {model.sizes[role]}U) ? 1 : -1];")
            for number, one in enumerate(model.fields.get(role, ())):
                lines.append(f"typedef char {role}_{number}_at_{one.offset_bytes}[")
                condition = f"offsetof({kind}, {one.name}) == {one.offset_bytes}U"
                lines.append(f"  ({condition}) ? 1 : -1];")
        return "\n".join([*lines, ""])


def _check_known(used: Sequence[str] | Mapping[str, object] | set[str], known: set[str],
                 what: str) -> None:  # fmt: skip
    for name in sorted(set(used) - known):
        raise DesignError(
            f"the model has no {what} called '{name}'; there are: {', '.join(sorted(known))}"
        )


def _variable(role: str) -> str:
    return f"Model_{role.capitalize()}"


def _data(role: str) -> str:
    return role.capitalize()


def _converted(value: str, kind: str, wanted: str) -> str:
    return value if kind == wanted else f"{wanted} ({value})"


def _literal(value: float) -> str:
    mantissa, exponent_mark, exponent = repr(float(value)).partition("e")
    mantissa = mantissa if "." in mantissa else f"{mantissa}.0"
    return f"{mantissa}{exponent_mark}{exponent}"


def _assigned(target: str, wanted: str, terms: Sequence[tuple[str, str, float]]) -> list[str]:
    """`target` := sum of value times factor, limited where `wanted` is an integer type."""
    limits = _LIMITS.get(wanted)
    kinds = {wanted if limits is None else "Float", *(kind for _, kind, _ in terms)}
    wide = "Long_Float" in kinds or any("_32" in kind for kind in {wanted, *kinds})
    working = "Long_Float" if wide else "Float"
    lines = []
    for number, (value, kind, factor) in enumerate(terms):
        text = _converted(value, kind, working)
        text += "" if abs(factor) == 1 else f" * {_literal(abs(factor))}"
        sign = "-" if factor < 0 else ""
        lines.append(f"{sign}{text}" if number == 0 else f"{sign or '+'} {text}")
    if limits is not None:
        low, high = (_literal(limit) for limit in limits)
        lines[0] = f"{wanted} ({working}'Max ({low}, {working}'Min ({high}, {lines[0]}"
        lines[-1] += ")))"
    elif wanted != working:
        lines[0] = f"{wanted} ({lines[0]}"
        lines[-1] += ")"
    return [f"      {target} :=", *(f"        {line}" for line in lines[:-1]),
            f"        {lines[-1]};"]  # fmt: skip
