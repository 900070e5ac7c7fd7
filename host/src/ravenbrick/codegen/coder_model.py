# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""A folder that Embedded Coder wrote becomes files that an application is built with."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ravenbrick.codegen.ada.binding import AdaBinding, ada_binding
from ravenbrick.codegen.c.declarations import NUMBERS
from ravenbrick.codegen.c.header import ModelHeader, read_header
from ravenbrick.codegen.c.rtwtypes import RTWTYPES
from ravenbrick.errors import DesignError
from ravenbrick.toml_values import toml_values

__all__ = ["CoderModel", "read_binding", "read_coder_model"]

_INCLUDE = re.compile(r'^[ \t]*#[ \t]*include[ \t]*"([^"]+)"', re.MULTILINE)
_SYSTEM_INCLUDE = re.compile(r"^[ \t]*#[ \t]*include[ \t]*<([^>]+)>", re.MULTILINE)
_SIZED = re.compile(r"^\s*typedef\s+([a-z ]+?)\s+(u?int(\d+)_T)\s*;", re.MULTILINE)
_MAIN = re.compile(r"^\s*(?:int|int_T|void)\s+main\s*\(", re.MULTILINE)
# Headers of the tool's own folder, of which a model with one discrete rate uses nothing.
_EMPTY = ("rtw_continuous.h", "rtw_solver.h")
# Headers that no folder of shared utilities has: whose they are, and the setting that avoids them.
_FOREIGN = {
    re.compile(r"arm_\w+\.h|mw_cmsis\.h|cmsis\w*\.h|core_c\w+\.h"): (
        "belongs to the CMSIS library for Cortex-M, which this ARM7 does not have; set 'Code "
        "replacement library' to None"
    ),
    re.compile(r"MW_\w+\.h|\w*(?:stm32|stm_|[Aa]rduino|_board|SysTick|cortex)\w*\.h"): (
        "belongs to the support package of a board; set 'Hardware board' to None and replace its "
        "blocks by inports and outports"
    ),
    re.compile(r"simstruc\w*\.h|rt_(?:sim|logging|mxclassid|matrx)\w*\.h|ext_work\.h"): (
        "belongs to simulations on a computer; set the system target file to ert.tlc, and switch "
        "'MAT-file logging' and 'External mode' off"
    ),
}
_C_LIBRARY = ("math.h", "stddef.h", "stdlib.h", "string.h", "limits.h", "float.h", "stdint.h")
_TITLE = (
    "/* SPDX-FileCopyrightText: 2026 Ravenbrick contributors */\n"
    "/* SPDX-License-Identifier: Apache-2.0 */\n"
)
_TABLES = ("names", "types", "inputs", "outputs", "values")


@dataclass(frozen=True)
class CoderModel:
    """A generated model: its `interface`, the `header`'s file name, all C files by name.

    `supplied` names the files that the folder did not have and that are ours.
    """

    interface: ModelHeader
    header: str
    files: Mapping[str, str]
    supplied: tuple[str, ...]

    def files_with_binding(self, binding: AdaBinding) -> dict[str, str]:
        """The C files and those of the Ada binding."""
        others = {name: text for name, text in self.files.items() if name != self.header}
        return {
            **self.files,
            **ada_binding(self.files[self.header], binding, self.header, others),
        }


def read_coder_model(folder: Path) -> CoderModel:
    """The model in a folder such as `functional_ert_rtw`; its example of a main program is left.

    Raises `DesignError` if there is not exactly one model, or if a header is missing.
    """
    texts = {
        path.name: path.read_text(encoding="utf-8", errors="replace")
        for path in sorted(folder.glob("*.[ch]"))
    }
    texts = {name: text for name, text in texts.items() if not _MAIN.search(text)}
    models = [name for name, text in texts.items() if _declares(name, text, "_initialize")]
    models = models or [name for name in texts if _has_own_names(name, texts)]
    if len(models) != 1:
        found = ", ".join(models) or "none"
        raise DesignError(
            f"{folder}: there must be one header <model>.h that declares <model>_initialize; "
            f"found: {found}"
        )
    supplied = _supply(folder, texts)
    _check_sizes(folder, texts.get("rtwtypes.h", ""))
    interface = _interface(models[0], texts)
    return CoderModel(interface, models[0], {**texts, **supplied}, tuple(sorted(supplied)))


def _declares(name: str, text: str, ending: str) -> bool:
    stem, _, kind = name.rpartition(".")
    return kind == "h" and re.search(rf"\b{re.escape(stem)}{ending}\s*\(", text) is not None


def _has_own_names(name: str, texts: Mapping[str, str]) -> bool:
    """A header beside a source and a header of types: the model's, whatever its functions."""
    stem, _, kind = name.rpartition(".")
    types = re.search(rf"\b(?:RT_MODEL|ExtU|ExternalInputs)_{re.escape(stem)}", texts[name])
    return kind == "h" and f"{stem}.c" in texts and types is not None


def _interface(name: str, texts: Mapping[str, str]) -> ModelHeader:
    others = {other: text for other, text in texts.items() if other != name}
    return read_header(texts[name], name, others)


def _supply(folder: Path, texts: Mapping[str, str]) -> dict[str, str]:
    wanted = {name for text in texts.values() for name in _INCLUDE.findall(text)}
    system = {name for text in texts.values() for name in _SYSTEM_INCLUDE.findall(text)}
    missing = sorted(wanted - set(texts) - set(_C_LIBRARY))
    for name in (*missing, *sorted(system - set(_C_LIBRARY))):
        for pattern, meaning in _FOREIGN.items():
            if pattern.fullmatch(name):
                raise DesignError(f"{folder}: {name} {meaning}, and generate the model again")
    unknown = [name for name in missing if name not in (*_EMPTY, "rtwtypes.h")]
    if unknown:
        raise DesignError(
            f"{folder}: {', '.join(unknown)} is included and not there; copy it from the folder "
            "of shared utilities (slprj/ert/_sharedutils) to the model's"
        )
    own = {name: f"{_TITLE}/* {name}: nothing of it is used here. */\n" for name in _EMPTY}
    own["rtwtypes.h"] = f"{_TITLE}{RTWTYPES}"
    return {name: own[name] for name in missing}


def _check_sizes(folder: Path, types: str) -> None:
    """Raises `DesignError` if rtwtypes.h is for a processor with other word lengths."""
    for base, name, bits in _SIZED.findall(types):
        words = base.replace("signed", "").replace("un", "").split()
        found = 8 * NUMBERS["int64_T" if words.count("long") == 2 else (words or ["int"])[0]]
        if found != int(bits):
            raise DesignError(
                f"{folder / 'rtwtypes.h'}: {name} is '{base}', which has {found} bits on the NXT; "
                "set the device type to 'ARM Compatible->ARM 7' and generate the model again"
            )


def read_binding(path: Path) -> AdaBinding:
    """The binding that a TOML file describes; raises `DesignError` that names the field."""
    try:
        data = toml_values(path.read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError) as error:
        raise DesignError(f"{path}: {error}") from error
    unknown = sorted(set(data) - {"package", "without_effect", *_TABLES})
    if unknown:
        raise DesignError(
            f"{path}: unknown field '{unknown[0]}'; there are: package, without_effect, "
            f"{', '.join(_TABLES)}"
        )
    package = data.get("package")
    if not isinstance(package, str) or not re.fullmatch(r"[A-Za-z]\w*", package):
        raise DesignError(f'{path}: package must be an Ada name, such as "Speed_Controller"')
    tables = {name: _table(path, data, name) for name in _TABLES}
    for name in ("names", "types"):
        _check(path, name, tables[name], lambda value: isinstance(value, str), "a text")
    for name in ("inputs", "outputs"):
        for port, sources in tables[name].items():
            if not isinstance(sources, dict):
                raise DesignError(f"{path}: {name}.{port} must be a table of factors")
            _check(path, f"{name}.{port}", sources, _is_number, "a number")
    _check(path, "values", tables["values"], _is_values, "a number or a list of numbers")
    without = data.get("without_effect", [])
    if not isinstance(without, list) or not all(isinstance(name, str) for name in without):
        raise DesignError(f"{path}: without_effect must be a list of names")
    return AdaBinding(package=package, without_effect=tuple(without), **tables)


def _table(path: Path, data: Mapping[str, Any], name: str) -> dict[str, Any]:
    table = data.get(name, {})
    if not isinstance(table, dict):
        raise DesignError(f"{path}: {name} must be a table")
    return table


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _is_values(value: object) -> bool:
    return _is_number(value) or (isinstance(value, list) and all(map(_is_number, value)))


def _check(path: Path, field: str, table: Mapping[str, Any], good: Any, wanted: str) -> None:
    for name, value in table.items():
        if not good(value):
            raise DesignError(f"{path}: {field}.{name} must be {wanted}, not {value!r}")
