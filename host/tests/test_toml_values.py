# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""TOML texts that anybody may have written."""

from __future__ import annotations

import resource
import tomllib

import pytest

from ravenbrick.toml_values import PARTS_MAX, toml_values


def test_keys_of_some_parts_are_read() -> None:
    """Bare and quoted ones, and dots that are in no key."""
    text = f'{"a." * (PARTS_MAX - 2)}b = 1\n"c.d"."e" = "{"and so on ... " * 100}"\n'
    text += f"f = [{'1.5, ' * 100}]\n"
    values = toml_values(text)
    assert values == tomllib.loads(text) and values["c.d"]["e"].startswith("and")


@pytest.mark.parametrize("part", ["a.", "a-1 . ", '"a b".', "'a'. ", '"\\"".'])
@pytest.mark.parametrize("form", ["b = 1\n{}a = 1\n", "b = 1\n[{}a]\n", "b = {{ {}a = 1 }}\n"])
def test_a_key_of_thousands_of_parts_is_refused_at_once(part: str, form: str) -> None:
    """The parser would take gigabytes for it; the error has the line."""
    before = resource.getrusage(resource.RUSAGE_SELF)
    with pytest.raises(tomllib.TOMLDecodeError, match=r"more than 50 parts \(at line [12], col"):
        toml_values(form.format(part * 100_000))
    after = resource.getrusage(resource.RUSAGE_SELF)
    assert after.ru_maxrss - before.ru_maxrss < 100_000
    assert after.ru_utime - before.ru_utime < 60


@pytest.mark.parametrize("piece", ['"', '\\"', "a", "a ", "''", '"a" ', "a.b ", "["])
def test_the_search_for_long_keys_takes_time_in_proportion_to_the_text(piece: str) -> None:
    """Of a million letters that are no TOML, within seconds."""
    before = resource.getrusage(resource.RUSAGE_SELF).ru_utime
    with pytest.raises((tomllib.TOMLDecodeError, RecursionError)):
        toml_values("x = 1 " + piece * (1_000_000 // len(piece)))
    assert resource.getrusage(resource.RUSAGE_SELF).ru_utime - before < 60
