# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Variables of a workspace: assignments of an .m file, which is not run, or a .mat file."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from ravenbrick.errors import DesignError
from ravenbrick.simulink.matlab.linear_systems import Systems
from ravenbrick.simulink.matlab.statements import split
from ravenbrick.simulink.numbers import Workspace

__all__ = ["assignments", "read_workspace", "script"]

_LARGEST_BYTES = 4 << 20
_NAME = r"[A-Za-z_]\w*(?:\.[A-Za-z_]\w*)*"
_ASSIGNMENT = re.compile(rf"\s*(?:({_NAME})|\[([^\]]+)\])\s*=(?!=)\s*(.+)\Z", re.DOTALL)
_TARGET = re.compile(rf"{_NAME}|~")
_SCRIPT = re.compile(r"\s*(?:run\s*\(?\s*)?'?([A-Za-z]\w*)(?:\.m)?'?\s*\)?\s*\Z")
_PROGRAM = re.compile(r"\s*(?:%[^\n]*\n\s*)*(?:function|classdef)\b")
_DEEPEST = 5
_LOAD = re.compile(r"\s*load\s*\(?\s*'?([\w./-]+?)'?\s*\)?\s*\Z")


def read_workspace(path: Path) -> Workspace:
    """The variables that a file of either kind gives.

    Of an .m file assignments of numbers, vectors and matrices are taken, with arithmetic,
    mathematical functions, linear systems and their designs (`Systems`), from top to bottom, and
    .mat files that it loads from its own folder.
    Everything else in it is left out; a variable that is missed is named when a block wants it.
    Raises `DesignError` for a file that is neither.
    """
    found = Workspace({})
    _read(path, found)
    return found


def _read(path: Path, found: Workspace) -> None:
    if path.suffix == ".mat":
        _read_mat(path, found)
        return
    try:
        data = path.read_bytes()
    except OSError as error:
        raise DesignError(f"{path}: cannot be read: {error.strerror}") from error
    if path.suffix != ".m" or len(data) > _LARGEST_BYTES:
        raise DesignError(f"{path}: expected an .m or .mat file below {_LARGEST_BYTES >> 20} MB")
    assignments(data.decode("utf-8", errors="replace"), path.parent, found)


def assignments(text: str, folder: Path, found: Workspace) -> None:
    """Add what a program in MATLAB's language assigns.

    `folder` holds .mat files that it loads and scripts that it names.
    """
    _assign(text, folder, found, Systems(found), 0)


def script(path: Path) -> str | None:
    """The text of an .m file; None for one that is a function, a class or too large."""
    if not path.is_file() or path.stat().st_size > _LARGEST_BYTES:
        return None
    text = path.read_text(encoding="utf-8", errors="replace")
    return None if _PROGRAM.match(text) else text


def _assign(text: str, folder: Path, found: Workspace, systems: Systems, depth: int) -> None:
    for _, statement in split(text):
        named = _SCRIPT.match(statement)
        if named and depth < _DEEPEST:
            inner = script(folder / f"{named[1]}.m")
            if inner is not None:
                _assign(inner, folder, found, systems, depth + 1)
            continue
        load = _LOAD.match(statement)
        if load:
            other = folder / load[1]
            other = other if other.suffix else other.with_suffix(".mat")
            if other.suffix == ".mat" and other.is_file():
                _read_mat(other, found)
            continue
        match = _ASSIGNMENT.match(statement)
        if match is None:
            continue
        names = [match[1]] if match[1] else _TARGET.findall(match[2])
        try:
            systems.assign(names, _without_object(match[3]))
        except ValueError:
            systems.forget(names)


def _without_object(text: str) -> str:
    """The number in `Simulink.Parameter(5)`."""
    match = re.fullmatch(r"\s*Simulink\.Parameter\((.*)\)\s*", text, re.DOTALL)
    return match[1] if match else text


def _read_mat(path: Path, found: Workspace) -> None:
    from scipy.io import loadmat  # slow to load

    try:
        values = loadmat(path, simplify_cells=True)
    except (OSError, ValueError, NotImplementedError, TypeError, KeyError) as error:
        raise DesignError(f"{path}: is no .mat file up to version 7: {error}") from error
    for name, value in values.items():
        if not name.startswith("__"):
            _take(name, value, found)


def _take(name: str, value: object, found: Workspace) -> None:
    if isinstance(value, dict):
        for inner, one in value.items():
            _take(f"{name}.{inner}", one, found)
        return
    array = np.asarray(value)
    if array.dtype.kind in "biuf" and array.ndim <= 2:
        found[name] = array.astype(float)
