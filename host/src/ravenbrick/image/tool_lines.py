# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The tools of a build in one line each, from what they print when they are asked to be verbose."""

from __future__ import annotations

import re

__all__ = ["tool_line"]

_CHATTER = re.compile(
    r"COLLECT|COMPILER_PATH|LIBRARY_PATH|Configured with|Target:|Thread model|Using built-in|"
    r"Supported LTO|gcc version|GNU (assembler|C|Ada|ld)|Reading specs|No errors$|"
    r".*missing \.note\.GNU-stack|.*NOTE: This behaviour is deprecated|gprbuild: "
)
_MESSAGE = re.compile(
    r"\S[^\n]*?:\d+:|.*(error|warning|undefined|overflowed|cannot|failed|not found)"
)
_IMAGE = re.compile(r" -o (?:.*/)?(\S.*?\.elf) ")
_SCRIPT = re.compile(r"-T ?(\w+\.ld)")


def _after(words: list[str], option: str) -> str:
    return words[words.index(option) + 1] if option in words[:-1] else ""


def tool_line(line: str) -> str | None:
    """What to show for a line of the output: a tool with source and product, or a message."""
    words = line.split()
    tool = words[0].rpartition("/")[2] if words else ""
    if tool in ("gnat1", "cc1"):
        source, product = _after(words, "-dumpbase"), "assembly"
    elif tool == "as":
        source, product = "assembly", _after(words, "-o")
    elif tool.endswith("-gnatbind-12"):
        tool, source = "gnatbind", next((w for w in words if w.endswith(".ali")), "")
        product = _after(words, "-o")
    elif tool == "collect2":
        image, script = _IMAGE.search(line), _SCRIPT.search(line)
        tool, source = "ld", f"*.o by {script[1] if script else ''}"
        product = image[1] if image else ""
    elif not _CHATTER.match(line) and _MESSAGE.match(line):
        return line
    else:
        return None
    return f"  {tool:<9} {source.rpartition('/')[2]} -> {product.rpartition('/')[2]}"
