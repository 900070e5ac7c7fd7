# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The settings of Embedded Coder: each with its reason in the guide, and true for the compiler."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
SCRIPT = (ROOT / "examples" / "embedded-coder" / "nxt_settings.m").read_text()
GUIDE = (ROOT / "docs" / "guides" / "embedded-coder.md").read_text()
SET = dict(re.findall(r"^set_param\(model, '(\w+)', '([^']+)'\);", SCRIPT, re.MULTILINE))
BITS = dict(re.findall(r"^expect\(model, '(\w+)', (\d+)\);", SCRIPT, re.MULTILINE))


def test_the_guide_gives_a_reason_for_each_setting() -> None:
    """The same names and values in script and tables, and no other."""
    rows = re.findall(r"^\| `(\w+)` \| `([^`]+)` \| (.+) \|$", GUIDE, re.MULTILINE)
    assert {name: value for name, value, _ in rows} == SET
    assert all(len(reason) > 10 for _, _, reason in rows)
    lengths = re.findall(r"`(ProdBitPer\w+)` \| (\d+)", GUIDE)
    assert dict(lengths) == BITS
    assert "| `FixedStep` | the period in seconds |" in GUIDE


def test_word_lengths_are_those_of_the_compiler() -> None:
    """As its predefined macros say."""
    done = subprocess.run(
        ["arm-none-eabi-gcc", "-mcpu=arm7tdmi", "-dM", "-E", "-x", "c", "/dev/null"],
        capture_output=True,
        text=True,
        check=True,
    )
    macros = dict(re.findall(r"#define (\w+) (\S+)$", done.stdout, re.MULTILINE))
    names = {
        "Short": "SHORT", "Int": "INT", "Long": "LONG", "LongLong": "LONG_LONG", "Float": "FLOAT",
        "Double": "DOUBLE", "Pointer": "POINTER", "SizeT": "SIZE_T", "PtrDiffT": "PTRDIFF_T",
    }  # fmt: skip
    found = {f"ProdBitPer{n}": str(8 * int(macros[f"__SIZEOF_{m}__"])) for n, m in names.items()}
    assert found | {"ProdBitPerChar": macros["__CHAR_BIT__"]} == BITS
    assert macros["__BYTE_ORDER__"] == "__ORDER_LITTLE_ENDIAN__"
    assert SET["ProdEndianess"] == "LittleEndian"
