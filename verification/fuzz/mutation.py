# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""How right content is mutate_bytes."""

from __future__ import annotations

import hashlib
import json
import random
import struct
from typing import Any

__all__ = ["mutate_bytes", "mutate_snapshot"]

EDGES = (0, 1, 0x7F, 0x80, 0xFF)
# JSON values that are wrong in most places.
ODD_VALUES: tuple[Any, ...] = (
    None,
    True,
    -1,
    1 << 63,
    1 << 200,
    -(1 << 70),
    0.5,
    float("inf"),
    float("nan"),
    "",
    "\ud800",
    "\0",
    "9" * 5000,
    [],
    [[]],
    [[1, 2]],
    [["x", 1, 2]],
    [[-5, "touch.1", 1.0]],
    [[1 << 70, "touch.1", 1.0]],
    [[5, "touch.1", float("nan")]],
    [["nothing", "u8"]],
    {},
    {"a": 1},
)


def mutate_bytes(numbers: random.Random, content: bytes) -> bytes:
    """Some bytes changed, removed, repeated or added, or the rest cut off."""
    bad = bytearray(content)
    for _ in range(numbers.randint(1, 8)):
        at = numbers.randrange(len(bad) + 1)
        kind = numbers.randrange(8)
        if kind == 0 and numbers.randrange(4) == 0:
            del bad[at:]
        elif kind == 1:
            del bad[at : at + numbers.randint(1, 8)]
        elif kind == 2:
            bad[at:at] = numbers.randbytes(numbers.randint(1, 64))
        elif kind == 3:
            begin = numbers.randrange(len(bad) + 1)
            bad[at:at] = bad[begin : begin + numbers.randint(1, 64)]
        elif at < len(bad):
            bad[at] = numbers.choice([*EDGES, numbers.randrange(256), bad[at] ^ 1])
    return bytes(bad)


def mutate_snapshot(numbers: random.Random, content: bytes) -> bytes:
    """A snapshot file with wrong bytes or fields, mostly with a correct checksum."""
    body = content[:-32]
    if numbers.randrange(2):
        body = _with_odd_field(numbers, body)
    else:
        body = mutate_bytes(numbers, body)
    if numbers.randrange(8) == 0:
        return body + content[-32:]
    return body + hashlib.sha256(body).digest()


def _with_odd_field(numbers: random.Random, body: bytes) -> bytes:
    mark = body.index(b"\n") + 1
    version, length = struct.unpack_from("<II", body, mark)
    fields = json.loads(body[mark + 8 : mark + 8 + length])
    name = numbers.choice(sorted(fields))
    if numbers.randrange(8) == 0:
        del fields[name]
    elif numbers.randrange(8) == 0:
        fields = numbers.choice(ODD_VALUES)
    else:
        fields[name] = numbers.choice(ODD_VALUES)
    header = json.dumps(fields).encode()
    return (
        body[:mark] + struct.pack("<II", version, len(header)) + header + body[mark + 8 + length :]
    )
