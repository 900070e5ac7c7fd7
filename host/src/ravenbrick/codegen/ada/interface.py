# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""What the Ada bindings of generated models have in common: names, types, records."""

from __future__ import annotations

import textwrap
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from ravenbrick import __version__
from ravenbrick.codegen.ada.text import ada_name
from ravenbrick.codegen.c.header import CField, ModelHeader
from ravenbrick.errors import DesignError

__all__ = ["STEP", "AdaBinding", "Interface", "imported"]

_COMMENT_WIDTH = 84
ADA_TYPES = {
    **dict.fromkeys(("real32_T", "float"), "Float"),
    **dict.fromkeys(("real_T", "real64_T", "double", "time_T"), "Long_Float"),
    **dict.fromkeys(("int8_T", "int8_t", "char_T", "signed char"), "Interfaces.Integer_8"),
    **dict.fromkeys(("uint8_T", "uint8_t", "boolean_T", "bool", "_Bool"), "Interfaces.Unsigned_8"),
    **dict.fromkeys(("uchar_T", "byte_T", "char", "unsigned char"), "Interfaces.Unsigned_8"),
    **dict.fromkeys(("int16_T", "int16_t", "short"), "Interfaces.Integer_16"),
    **dict.fromkeys(("uint16_T", "uint16_t", "unsigned short"), "Interfaces.Unsigned_16"),
    **dict.fromkeys(("int32_T", "int32_t", "int_T", "int", "long"), "Interfaces.Integer_32"),
    **dict.fromkeys(("uint32_T", "uint32_t", "uint_T", "ulong_T"), "Interfaces.Unsigned_32"),
    **dict.fromkeys(("unsigned", "unsigned int", "unsigned long"), "Interfaces.Unsigned_32"),
    **dict.fromkeys(("int64_T", "int64_t"), "Interfaces.Integer_64"),
    **dict.fromkeys(("uint64_T", "uint64_t"), "Interfaces.Unsigned_64"),
}
RECORDS = {
    "inputs": "External_Inputs",
    "outputs": "External_Outputs",
    "work": "Work_Area",
    "parameters": "Tunable_Parameters",
}


@dataclass(frozen=True)
class AdaBinding:
    """How the application wants to see the model.

    `package` is the Ada package's name, `names` gives Ada names of fields, `types` by field name or
    by unit an Ada type `Package.Type` derived from Float. In an interface that is not in single
    precision, fields with such a type are converted.

    The rest is for a model whose ports are not the application's. `inputs` gives for a port of the
    model the application's fields with their factors: `{"error": {"Wanted": 1, "Actual": -1}}`;
    `outputs` for a field of the application the model's ports likewise. `values` are set in the
    parameters at the start (`{"pid.P": 0.31}`), `without_effect` are parameters that the
    application sets and the model does not have.
    """

    package: str
    names: Mapping[str, str] = field(default_factory=dict)
    types: Mapping[str, str] = field(default_factory=dict)
    inputs: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    outputs: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    values: Mapping[str, float | Sequence[float]] = field(default_factory=dict)
    without_effect: Sequence[str] = ()

    @property
    def maps(self) -> bool:
        """Whether something of the model is not shown as it is."""
        return bool(self.inputs or self.outputs or self.values or self.without_effect)


class Interface:
    """Names, types and records that the application sees."""

    def __init__(self, model: ModelHeader, binding: AdaBinding) -> None:
        self.model = model
        self.binding = binding

    def name(self, one: CField) -> str:
        """The field's Ada name."""
        return self.binding.names.get(one.name) or ada_name(one.name.replace(".", "_"))

    def own_type(self, one: CField) -> str | None:
        """The application's type of a field, if it has one."""
        types = self.binding.types
        return types.get(one.name) or (types.get(one.unit) if one.unit else None)

    def c_type(self, one: CField) -> str:
        """The Ada type that C's type is."""
        return ADA_TYPES[one.c_type]

    def application_type(self, one: CField) -> str:
        """The type that the application sees."""
        own = self.own_type(one)
        return self.c_type(one) if own is None or one.length is not None else own

    def field_lines(self, one: CField, kind: str) -> list[str]:
        """A component of a record with its comment."""
        if one.length is not None:
            kind = f"{kind.rpartition('.')[2]}_Values_{one.length}"
        lines = [f"      {self.name(one)} : {kind};"]
        return [*lines, *(f"      --  {line}" for line in textwrap.wrap(one.about, _COMMENT_WIDTH))]

    def arrays(self, roles: Sequence[str]) -> list[str]:
        """Types of the arrays in the structures."""
        kinds = {
            (self.c_type(one), one.length)
            for role in roles
            for one in self.model.fields.get(role, ())
            if one.length is not None
        }
        return [
            f"   type {kind.rpartition('.')[2]}_Values_{length} is array (1 .. {length}) of {kind};"
            for kind, length in sorted(kinds)
        ]

    def check_names(self, roles: Sequence[str]) -> None:
        """Ada does not tell capitals apart: no two fields of a structure may have one name."""
        for role in roles:
            seen: dict[str, str] = {}
            for one in self.model.fields.get(role, ()):
                name = self.name(one).lower()
                if name in seen:
                    raise DesignError(
                        f"'{seen[name]}' and '{one.name}' of {self.model.types[role]} have the "
                        "same name in Ada; give one of them another in `names`"
                    )
                seen[name] = one.name

    def file(self, kind: str, lines: Sequence[str], spec: Sequence[str] = ()) -> str:
        """A compilation unit: `package` or `package body`, with the lines of its specification."""
        package = self.binding.package
        head = [
            "--  SPDX-FileCopyrightText: 2026 Ravenbrick contributors",
            "--  SPDX-License-Identifier: Apache-2.0",
            "",
            f"--  Generated by ravenbrick {__version__}: do not edit.",
            f"--  {self.model.model}.h in Ada.",
            "",
        ]
        text = [
            *head,
            *self._with(lines, spec),
            f"{kind} {package} is",
            "",
            *lines,
            f"end {package};",
            "",
        ]
        return "\n".join(text)

    def _with(self, lines: Sequence[str], spec: Sequence[str]) -> list[str]:
        """Context clauses of what `lines` name and the specification does not."""
        packages = sorted({t.rpartition(".")[0] for t in self.binding.types.values()} - {""})
        text, seen = "\n".join(lines), "\n".join(spec)
        packages = [p for p in [*packages, "Interfaces", "System"] if f"{p}." in text]
        packages = [p for p in packages if f"{p}." not in seen]
        return [*(f"with {package};" for package in packages), ""] if packages else []


STEP = [
    "   procedure Step",
    "     (Work    : in out Work_Area;",
    "      Inputs  : External_Inputs;",
    "      Outputs : out External_Outputs)",
]


def imported(symbol: str) -> str:
    """The aspects of something that C provides."""
    return f'     Import, Convention => C, External_Name => "{symbol}";'
