# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""Entries of the catalogue that a `robot.toml` names, filled in before it is checked."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from ravenbrick.catalogue import parts
from ravenbrick.schemas.located_toml import KeyPath, LocatedToml

__all__ = ["with_named_parts"]


def _filled(document: LocatedToml, path: KeyPath, group: str, table: Any) -> Any:
    """The entry that `catalogue` of this table names, with what the table itself says."""
    if not isinstance(table, dict) or not isinstance(table.get("catalogue"), str):
        return table
    entries = parts(group)
    if table["catalogue"] not in entries:
        known = ", ".join(f"'{name}'" for name in entries)
        problem = f"the catalogue has no '{table['catalogue']}' among its {group}; it has {known}"
        raise document.error((*path, "catalogue"), problem)
    return {**entries[table["catalogue"]], **table}


def _motors(document: LocatedToml) -> Any:
    """The parameter sets of the file, and those of the catalogue that its ports name."""
    written, ports = document.values.get("motors", {}), document.values.get("ports", {})
    if not isinstance(written, dict) or not isinstance(ports, dict):
        return written
    named = [port.get("motor") for port in ports.values() if isinstance(port, dict)]
    used = {name: entry for name, entry in parts("motors").items() if name in named}
    filled = {
        name: _filled(document, ("motors", name), "motors", table)
        for name, table in written.items()
    }
    return {**used, **filled}


def with_named_parts(document: LocatedToml) -> LocatedToml:
    """The same file with every constant; lines stay those of what is written down.

    Raises `ProjectFileError` for an entry that the catalogue does not have.
    """
    values = {**document.values, "motors": _motors(document)}
    for name, group in (("body", "bodies"), ("battery", "batteries")):
        if name in values:
            values[name] = _filled(document, (name,), group, values[name])
    return replace(document, values=values)
