# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The Ada package through which an application calls a generated model, from the C header."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from ravenbrick import __version__
from ravenbrick.codegen.ada_text import ada_name, wrapped
from ravenbrick.codegen.c_header import CField, ModelHeader, read_header
from ravenbrick.errors import DesignError

__all__ = ["AdaBinding", "ada_binding"]

_ADA_TYPES = {
    **dict.fromkeys(("real32_T", "float"), "Float"),
    **dict.fromkeys(("real_T", "real64_T", "double", "time_T"), "Long_Float"),
    **dict.fromkeys(("int8_T", "int8_t", "char_T"), "Interfaces.Integer_8"),
    **dict.fromkeys(("uint8_T", "uint8_t", "boolean_T", "bool"), "Interfaces.Unsigned_8"),
    **dict.fromkeys(("int16_T", "int16_t"), "Interfaces.Integer_16"),
    **dict.fromkeys(("uint16_T", "uint16_t"), "Interfaces.Unsigned_16"),
    **dict.fromkeys(("int32_T", "int32_t", "int_T", "int"), "Interfaces.Integer_32"),
    **dict.fromkeys(("uint32_T", "uint32_t", "uint_T", "ulong_T"), "Interfaces.Unsigned_32"),
    **dict.fromkeys(("int64_T", "int64_t"), "Interfaces.Integer_64"),
    **dict.fromkeys(("uint64_T", "uint64_t"), "Interfaces.Unsigned_64"),
}
_RECORDS = {
    "inputs": "External_Inputs",
    "outputs": "External_Outputs",
    "work": "Work_Area",
    "signals": "Block_Signals",
    "parameters": "Tunable_Parameters",
}


@dataclass(frozen=True)
class AdaBinding:
    """How the application wants to see the model.

    `package` is the Ada package's name, `names` gives Ada names of fields, `types` by field name or
    by unit an Ada type `Package.Type` derived from Float. In an interface that is not in single
    precision, fields with such a type are converted.
    """

    package: str
    names: Mapping[str, str] = field(default_factory=dict)
    types: Mapping[str, str] = field(default_factory=dict)


def ada_binding(header: str, binding: AdaBinding, file: str = "header") -> dict[str, str]:
    """File text by file name: the specification, and a body where the C needs an adapter.

    A reentrant model (ours) is imported as it is. One with a single instance (Embedded Coder's
    default) gets a body that keeps each `Work_Area` beside the model's own state and copies it in
    and out, so that the application is the same for both. Raises `DesignError` for a header that
    is not understood.
    """
    return _Binding(read_header(header, file), binding).files()


class _Binding:
    def __init__(self, model: ModelHeader, binding: AdaBinding) -> None:
        self._model = model
        self._binding = binding
        self._adapter = not model.reentrant
        if self._adapter:
            self._check_single()

    def _check_single(self) -> None:
        """An adapter needs a step without arguments and the variables that it works on."""
        model = self._model
        for name in (f"{model.model}_initialize", f"{model.model}_step"):
            if model.functions.get(name) not in ("void", ""):
                raise DesignError(
                    f"the model's entry point {name} takes arguments or is missing; generate the "
                    "model with nonreusable functions and one rate"
                )
        for role in model.types:
            if role not in model.symbols:
                raise DesignError(f"the header declares no variable of type {model.types[role]}")

    def _name(self, one: CField) -> str:
        return self._binding.names.get(one.name) or ada_name(one.name)

    def _own_type(self, one: CField) -> str | None:
        """The application's type of a field, if it has one."""
        types = self._binding.types
        return types.get(one.name) or (types.get(one.unit) if one.unit else None)

    def _c_type(self, one: CField) -> str:
        return _ADA_TYPES[one.c_type]

    def _application_type(self, one: CField) -> str:
        own = self._own_type(one)
        if own is None or one.length is not None:
            return self._c_type(one)
        if not self._adapter and one.size_bytes != 4:
            raise DesignError(
                f"field '{one.name}' is {one.c_type}, but {own} is derived from Float; leave it "
                "out of `types`"
            )
        return own

    def _record(self, role: str, *, outside: bool) -> list[str]:
        """A record with the application's types (`outside`) or with those of the C."""
        model = self._model
        name = _RECORDS[role] if outside or not self._adapter else model.types[role]
        limited = "limited " if role == "work" and not self._adapter else ""
        lines = [f"   type {name} is {limited}record"]
        for one in model.fields.get(role, ()):
            kind = self._application_type(one) if outside else self._c_type(one)
            if one.length is not None:
                kind = f"{kind.rpartition('.')[2]}_Values_{one.length}"
            lines.append(f"      {self._name(one)} : {kind};")
            lines += [f"      --  {line}" for line in wrapped(one.about, 0)]
        if not model.fields.get(role):
            lines.append("      null;")
            return [*lines, "   end record;", ""]
        if outside and self._adapter:
            return [*lines, "   end record;", ""]
        size = model.size_bits(role)
        return [*lines, f"   end record with Convention => C, Size => {size};", ""]

    def _arrays(self, roles: Sequence[str]) -> list[str]:
        kinds = {
            (self._c_type(one), one.length)
            for role in roles
            for one in self._model.fields.get(role, ())
            if one.length is not None
        }
        return [
            f"   type {kind.rpartition('.')[2]}_Values_{length} is array (1 .. {length}) of {kind};"
            for kind, length in sorted(kinds)
        ]

    def _head(self) -> list[str]:
        return [
            "--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors",
            "--  SPDX-License-Identifier: Apache-2.0",
            "",
            f"--  Generated by ravenbrick {__version__}: do not edit.",
            f"--  {self._model.model}.h in Ada.",
            "",
        ]

    def _with(self, lines: Sequence[str]) -> list[str]:
        packages = sorted({t.rpartition(".")[0] for t in self._binding.types.values()} - {""})
        text = "\n".join(lines)
        packages = [p for p in [*packages, "Interfaces"] if f"{p}." in text]
        return [*(f"with {package};" for package in packages), ""] if packages else []

    def files(self) -> dict[str, str]:
        """Specification and, with an adapter, body."""
        package = self._binding.package
        spec = self._adapted_spec() if self._adapter else self._imported_spec()
        lines = [*self._head(), *self._with(spec), f"package {package} is", "", *spec]
        found = {f"{package.lower()}.ads": "\n".join([*lines, f"end {package};", ""])}
        if self._adapter:
            body = self._body()
            lines = [*self._head(), f"package body {package} is", "", *body]
            found[f"{package.lower()}.adb"] = "\n".join([*lines, f"end {package};", ""])
        return found

    def _imported_spec(self) -> list[str]:
        model = self._model.model
        roles = [r for r in ("inputs", "outputs", "work", "parameters") if r in self._model.types]
        lines = self._arrays(roles)
        for role in roles:
            lines += self._record(role, outside=True)
        if "parameters" in roles:
            symbol = self._model.symbols["parameters"]
            lines += [f"   Parameters : {_RECORDS['parameters']} with", _imported(symbol, 5), ""]
        first = _imported(f"{model}_initialize_instance", 5)
        second = _imported(f"{model}_step_instance", 5)
        return [
            *lines,
            "   procedure Initialize (Work : in out Work_Area) with", first, "",
            *_STEP, "   with", second, "   --  One sample of one instance", "",
        ]  # fmt: skip

    def _adapted_spec(self) -> list[str]:
        """The same for the application; the work area holds what the model keeps between steps."""
        roles = ["inputs", "outputs", *(["parameters"] if self._has("parameters") else [])]
        lines = self._arrays([*roles, *self._kept()])
        for role in roles:
            lines += self._record(role, outside=True)
        if self._has("parameters"):
            lines += ["   Parameters : Tunable_Parameters;", ""]
        lines += ["   type Work_Area is limited private;", ""]
        lines += ["   procedure Initialize (Work : in out Work_Area);", ""]
        lines += [*_STEP[:-1], f"{_STEP[-1]};", "   --  One sample of one instance", ""]
        lines += ["private", ""]
        for role in self._kept():
            lines += self._record(role, outside=False)
        parts = [f"      {_RECORDS[r]} : {self._model.types[r]};" for r in self._kept()]
        return [*lines, "   type Work_Area is record", *(parts or ["      null;"]),
                "   end record;", ""]  # fmt: skip

    def _has(self, role: str) -> bool:
        return bool(self._model.fields.get(role))

    def _kept(self) -> list[str]:
        return [role for role in ("work", "signals") if self._has(role)]

    def _body(self) -> list[str]:
        model = self._model
        inner = ["inputs", "outputs", *(["parameters"] if self._has("parameters") else [])]
        lines = []
        for role in inner:
            lines += self._record(role, outside=False)
        for role in [*inner, *self._kept()]:
            lines += [f"   {_variable(role)} : {model.types[role]} with"]
            lines += [_imported(model.symbols[role], 5), ""]
        for name, entry in (("Model_Initialize", "initialize"), ("Model_Step", "step")):
            lines += [f"   procedure {name} with", _imported(f"{model.model}_{entry}", 5), ""]
        kept = [(f"Work.{_RECORDS[role]}", _variable(role)) for role in self._kept()]
        lines += ["   procedure Initialize (Work : in out Work_Area) is", "   begin"]
        lines += ["      Model_Initialize;", *(f"      {a} := {b};" for a, b in kept)]
        lines += self._copied("parameters", inward=False)
        lines += ["   end Initialize;", "", *_STEP, "   is", "   begin"]
        lines += [f"      {b} := {a};" for a, b in kept]
        lines += self._copied("inputs", inward=True) + self._copied("parameters", inward=True)
        lines += ["      Model_Step;", *self._copied("outputs", inward=False)]
        return [*lines, *(f"      {a} := {b};" for a, b in kept), "   end Step;", ""]

    def _copied(self, role: str, *, inward: bool) -> list[str]:
        """Assignments of all fields between the application's record and the model's."""
        outside = {"inputs": "Inputs", "outputs": "Outputs", "parameters": "Parameters"}[role]
        lines = []
        for one in self._model.fields.get(role, ()):
            name = self._name(one)
            own, inner = f"{outside}.{name}", f"{_variable(role)}.{name}"
            kind = self._c_type(one) if inward else self._application_type(one)
            target, value = (inner, own) if inward else (own, inner)
            if self._application_type(one) != self._c_type(one):
                value = f"{kind} ({value})"
            lines.append(f"      {target} := {value};")
        return lines


_STEP = [
    "   procedure Step",
    "     (Work    : in out Work_Area;",
    "      Inputs  : External_Inputs;",
    "      Outputs : out External_Outputs)",
]


def _variable(role: str) -> str:
    return f"Model_{role.capitalize()}"


def _imported(symbol: str, indent: int) -> str:
    return f'{" " * indent}Import, Convention => C, External_Name => "{symbol}";'
