# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Stimuli from a value change dump (VCD, IEEE 1364): one variable per input.

A variable's name is its scopes and its reference, joined by dots. `x` and `z` mean that nothing
drives the input: it keeps its value. What this project exports can be played again: its inputs
are the variables below `inputs`.
"""

from __future__ import annotations

import io
from collections.abc import Iterator
from fractions import Fraction
from typing import Any

from ravenbrick.errors import ProjectFileError
from ravenbrick.installation import optional_module
from ravenbrick.project.stimuli import Channels, Sequence

__all__ = ["read"]

INPUT_SCOPE = "inputs"
_EXPONENTS = {"s": 0, "ms": 3, "us": 6, "ns": 9, "ps": 12, "fs": 15}


def _tokens(sequence: Sequence, reader: Any) -> Iterator[Any]:
    """The file's tokens; its syntax errors with their line."""
    tokens = reader.tokenize(io.BytesIO(sequence.path.read_bytes()))
    while True:
        try:
            token = next(tokens, None)
        except reader.VCDParseError as error:
            raise ProjectFileError(
                sequence.path, error.loc.line, "", f"not valid VCD: {error}; correct this line"
            ) from None
        if token is None:
            return
        yield token


class _Dump:
    """Declarations first, then changes."""

    def __init__(self, sequence: Sequence, channels: Channels, kinds: Any) -> None:
        self._sequence = sequence
        self._channels = channels
        self._kinds = kinds
        self._scopes: list[str] = []
        self._unit = Fraction(1)
        self._declared: dict[str, list[tuple[str, int]]] = {}
        self._inputs: dict[str, list[str]] = {}

    def take(self, token: Any) -> None:
        """Take one token into account."""
        kinds, line = self._kinds, token.span.start.line
        if token.kind is kinds.TIMESCALE:
            scale = token.timescale
            self._unit = Fraction(int(scale.magnitude), 10 ** _EXPONENTS[scale.unit.value])
        elif token.kind is kinds.SCOPE:
            self._scopes.append(token.scope.ident)
        elif token.kind is kinds.UPSCOPE:
            self._scopes.pop()
        elif token.kind is kinds.VAR:
            name = ".".join([*self._scopes, token.var.ref_str])
            self._declared.setdefault(token.var.id_code, []).append((name, line))
        elif token.kind is kinds.ENDDEFINITIONS:
            self._name_inputs(line)
        elif token.kind is kinds.CHANGE_TIME:
            self._sequence.at(line, token.time_change * self._unit)
        elif token.kind in (kinds.CHANGE_SCALAR, kinds.CHANGE_VECTOR, kinds.CHANGE_REAL):
            change = token.data
            for name in self._inputs.get(change.id_code, ()):
                self._change(line, name, change.value)

    def _name_inputs(self, line: int) -> None:
        """Own exports hold much besides the inputs; foreign files hold inputs only."""
        path, channels = self._sequence.path, self._channels
        everything = {name for names in self._declared.values() for name, _ in names}
        own = {name for name in everything if name.startswith(f"{INPUT_SCOPE}.")}
        channels.require(path, line, everything)
        for code, names in self._declared.items():
            for name, declared_line in names:
                if own and not channels.names and name not in own:
                    continue
                channel = name if channels.names else name.removeprefix(f"{INPUT_SCOPE}.")
                found = channels.input_of(path, declared_line, channel)
                if found is not None:
                    self._inputs.setdefault(code, []).append(found)

    def _change(self, line: int, name: str, value: Any) -> None:
        if isinstance(value, str):
            if value.strip("01") or not value:
                return
            value = int(value, 2)
        self._sequence.set(line, name, float(value))


def read(sequence: Sequence, channels: Channels) -> None:
    """Fill `sequence`; raises `ProjectFileError` with the line, `ToolMissingError`."""
    reader = optional_module("vcd.reader", "pyvcd", user="a stimulus in a VCD file")
    dump = _Dump(sequence, channels, reader.TokenKind)
    for token in _tokens(sequence, reader):
        dump.take(token)
