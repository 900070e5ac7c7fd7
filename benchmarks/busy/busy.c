/* SPDX-FileCopyrightText: 2026 Ravenbrick contributors */
/* SPDX-License-Identifier: Apache-2.0 */

/* A processor that never rests: sieve of Eratosthenes and a linear congruence, in RAM, for ever. */

enum { SIZE = 4096 };

static unsigned char composite[SIZE];
volatile unsigned primes_found;
volatile unsigned random_number;

/* There is no stack yet, and nothing to go back to. */
__attribute__((noreturn)) void _start(void);

void _start(void)
{
    unsigned random = 1;
    for (;;) {
        unsigned count = 0;
        for (unsigned i = 0; i < SIZE; i++) {
            composite[i] = 0;
        }
        for (unsigned i = 2; i < SIZE; i++) {
            if (!composite[i]) {
                count++;
                for (unsigned j = 2 * i; j < SIZE; j += i) {
                    composite[j] = 1;
                }
            }
            random = random * 1664525u + 1013904223u;
        }
        primes_found = count;
        random_number = random;
    }
}
