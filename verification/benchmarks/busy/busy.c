/* SPDX-FileCopyrightText: 2026 Ravenbrick contributors */
/* SPDX-License-Identifier: Apache-2.0 */

/* A processor that never rests: a table is stirred, byte by byte, for ever. There is no stack yet:
   the compiler must find room in the registers that a subprogram need not save. */

enum { SIZE = 4096 };

static unsigned char table[SIZE];
volatile unsigned checksum;

__attribute__((noreturn)) void _start(void);

void _start(void)
{
    unsigned sum = 1;
    for (;;) {
        for (unsigned i = 0; i < SIZE; i++) {
            sum = sum * 5 + table[i];
            table[i] = sum >> 24;
        }
        checksum = sum;
    }
}
