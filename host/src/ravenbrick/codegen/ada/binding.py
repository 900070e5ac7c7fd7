# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The Ada package through which an application calls a generated model, from the C header."""

from __future__ import annotations

from collections.abc import Mapping

from ravenbrick.codegen.ada.adapter import Adapter
from ravenbrick.codegen.ada.interface import RECORDS, STEP, AdaBinding, Interface, imported
from ravenbrick.codegen.c.header import CField, read_header
from ravenbrick.errors import DesignError

__all__ = ["AdaBinding", "ada_binding"]


def ada_binding(
    header: str,
    binding: AdaBinding,
    file: str = "header",
    others: Mapping[str, str] | None = None,
) -> dict[str, str]:
    """File text by file name: the specification, and a body where the C needs an adapter.

    A reentrant model (ours) is imported as it is. Embedded Coder's get an adapter in which the
    application sees the same package: with reusable functions, each `Work_Area` holds the data of
    one instance; with a single instance (its default), each `Work_Area` keeps the model's state
    and the adapter copies it in and out. With an adapter comes a C file that does not compile
    where a structure is not laid out as the Ada takes it. `others` are texts by name of headers
    that `header` includes. Raises `DesignError` for a header that is not understood.
    """
    model = read_header(header, file, others)
    if model.reentrant and not binding.maps:
        return _Imported(model, binding).files()
    return Adapter(model, binding, file).files()


class _Imported(Interface):
    """Our own model: every function and variable is imported."""

    def files(self) -> dict[str, str]:
        """The specification."""
        roles = [r for r in ("inputs", "outputs", "work", "parameters") if r in self.model.types]
        self.check_names(roles)
        lines = self.arrays(roles)
        for role in roles:
            lines += self._record(role)
        model = self.model.model
        if "parameters" in roles:
            symbol = self.model.symbols["parameters"]
            lines += [f"   Parameters : {RECORDS['parameters']} with", imported(symbol), ""]
        lines += ["   procedure Initialize (Work : in out Work_Area) with"]
        lines += [imported(f"{model}_initialize_instance"), ""]
        lines += [*STEP, "   with", imported(f"{model}_step_instance")]
        lines += ["   --  One sample of one instance", ""]
        return {f"{self.binding.package.lower()}.ads": self.file("package", lines)}

    def _seen_type(self, one: CField) -> str:
        kind = self.application_type(one)
        if kind != self.c_type(one) and one.size_bytes != 4:
            raise DesignError(
                f"field '{one.name}' is {one.c_type}, but {kind} is derived from Float; leave it "
                "out of `types`"
            )
        return kind

    def _record(self, role: str) -> list[str]:
        limited = "limited " if role == "work" else ""
        lines = [f"   type {RECORDS[role]} is {limited}record"]
        for one in self.model.fields[role]:
            lines += self.field_lines(one, self._seen_type(one))
        size = self.model.size_bits(role)
        return [*lines, f"   end record with Convention => C, Size => {size};", ""]
