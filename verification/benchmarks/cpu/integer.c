/* SPDX-FileCopyrightText: 2026 Ravenbrick contributors
   SPDX-License-Identifier: Apache-2.0 */
/* Integer work in loops: a shift register, a checksum bit by bit, a filter, an insertion sort. */
#include "program.h"

#define TABLE_WORDS 256

static word table[TABLE_WORDS] PLACE = {1};
static unsigned char bytes[TABLE_WORDS] PLACE = {1};

static word shifted(word state)
{
    state ^= state << 13;
    state ^= state >> 17;
    return state ^ state << 5;
}

static word checksum(word sum)
{
    for (int i = 0; i < TABLE_WORDS; i++) {
        sum ^= bytes[i];
        for (int bit = 0; bit < 8; bit++)
            sum = sum & 1 ? sum >> 1 ^ 0xEDB88320u : sum >> 1;
    }
    return sum;
}

static __attribute__((noinline)) word filtered(int count)
{
    int low = 0, high = 0;
    for (int i = 0; i < count; i++) {
        low += ((int)(table[i] & 0xFFFF) - low) * 13 >> 4;
        high = (high * 7 + low) >> 3;
        table[i] += (word)high;
    }
    return (word)low;
}

static void sorted(void)
{
    for (int i = 1; i < 64; i++) {
        word value = table[i];
        int at = i;
        for (; at > 0 && table[at - 1] > value; at--)
            table[at] = table[at - 1];
        table[at] = value;
    }
}

static __attribute__((noinline)) word scattered(word state)
{
    for (int i = 0; i < TABLE_WORDS; i++) {
        state = shifted(state);
        table[i] += state;
        bytes[state & (TABLE_WORDS - 1)] += (unsigned char)(state >> 8);
    }
    return state;
}

word result;

void run(void)
{
    word state = 1;
    for (int round = 0; round < ROUNDS; round++) {
        state = scattered(state);
        state += checksum(state);
        state ^= filtered(TABLE_WORDS);
        sorted();
    }
    result = state;
}
