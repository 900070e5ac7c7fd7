# SPDX-FileCopyrightText: 2026 Ravenbrick contributors
# SPDX-License-Identifier: Apache-2.0
"""The type header that generated models include, under the names Embedded Coder uses."""

from __future__ import annotations

import re
from collections.abc import Iterable

__all__ = ["RTWTYPES", "used_types"]

RTWTYPES = """\
#ifndef RTWTYPES_H
#define RTWTYPES_H

#include <limits.h>

/* Sizes assumed: char 8, short 16, int 32, long long 64 bits; IEEE 754 float and double. */
#if (UCHAR_MAX != 0xFF) || (USHRT_MAX != 0xFFFF) || (UINT_MAX != 0xFFFFFFFFU)
#error "rtwtypes.h: char, short and int must have 8, 16 and 32 bits"
#endif

typedef signed char int8_T;
typedef unsigned char uint8_T;
typedef short int16_T;
typedef unsigned short uint16_T;
typedef int int32_T;
typedef unsigned int uint32_T;
typedef long long int64_T;
typedef unsigned long long uint64_T;
typedef float real32_T;
typedef double real64_T;

typedef double real_T;
typedef double time_T;
typedef unsigned char boolean_T;
typedef int int_T;
typedef unsigned int uint_T;
typedef unsigned long ulong_T;
typedef char char_T;
typedef unsigned char uchar_T;
typedef char_T byte_T;
typedef void *pointer_T;

#ifndef false
#define false (0U)
#endif
#ifndef true
#define true (1U)
#endif

#define MAX_int8_T ((int8_T)(127))
#define MIN_int8_T ((int8_T)(-128))
#define MAX_uint8_T ((uint8_T)(255U))
#define MAX_int16_T ((int16_T)(32767))
#define MIN_int16_T ((int16_T)(-32768))
#define MAX_uint16_T ((uint16_T)(65535U))
#define MAX_int32_T ((int32_T)(2147483647))
#define MIN_int32_T ((int32_T)(-2147483647 - 1))
#define MAX_uint32_T ((uint32_T)(0xFFFFFFFFU))

typedef char rtwtypes_real32_has_4_bytes[(sizeof(real32_T) == 4U) ? 1 : -1];
typedef char rtwtypes_real64_has_8_bytes[(sizeof(real64_T) == 8U) ? 1 : -1];
typedef char rtwtypes_int64_has_8_bytes[(sizeof(int64_T) == 8U) ? 1 : -1];

#endif /* RTWTYPES_H */
"""


def used_types(texts: Iterable[str]) -> str:
    """The header with no more than the types named in the C texts."""
    named = set(re.findall(r"\b\w+_T\b", "".join(texts)))
    head, *_ = RTWTYPES.partition("typedef ")
    lines = [
        f"{line}\n"
        for line in RTWTYPES.splitlines()
        if (found := re.match(r"typedef [^;\[]* (\w+_T);", line)) and found[1] in named
    ]
    return f"{head}{''.join(lines)}\n#endif /* RTWTYPES_H */\n"
