/* SPDX-FileCopyrightText: 2026 Ravenbrick contributors
   SPDX-License-Identifier: Apache-2.0 */
/* Calls, tables and branches: an interpreter of postfix formulas, a recursive sort with a
   comparison by pointer, decimal text with divisions, and a hash of that text. */
#include "program.h"

#define COUNT 48
#define TEXT 16

typedef int (*comparison)(word, word);

enum operation { PUSH, ADD, SUBTRACT, MULTIPLY, SHIFT, EXCLUSIVE, DUPLICATE, SWAP, END };

static const unsigned char formula[] = {
    PUSH, 0, PUSH, 1, MULTIPLY, DUPLICATE, SHIFT, 5, ADD, PUSH, 2, SWAP, SUBTRACT,
    PUSH, 0, EXCLUSIVE, DUPLICATE, SHIFT, 3, EXCLUSIVE, END,
};
static word values[COUNT] PLACE = {1};
static word stack[8] PLACE = {1};
static char text[TEXT] PLACE = {1};
word result;

static __attribute__((noinline)) word evaluated(const word *inputs)
{
    const unsigned char *next = formula;
    word *top = stack;
    for (;;) {
        switch (*next++) {
        case PUSH: *top++ = inputs[*next++]; break;
        case ADD: top--; top[-1] += top[0]; break;
        case SUBTRACT: top--; top[-1] -= top[0]; break;
        case MULTIPLY: top--; top[-1] *= top[0]; break;
        case SHIFT: top[-1] >>= *next++; break;
        case EXCLUSIVE: top--; top[-1] ^= top[0]; break;
        case DUPLICATE: top[0] = top[-1]; top++; break;
        case SWAP: { word last = top[-1]; top[-1] = top[-2]; top[-2] = last; break; }
        default: return top[-1];
        }
    }
}

static __attribute__((noinline)) int upwards(word one, word other)
{
    return one < other;
}

static __attribute__((noinline)) int downwards(word one, word other)
{
    return one > other;
}

static void sort(word *first, word *last, comparison before)
{
    if (first >= last)
        return;
    word pivot = *(first + (last - first) / 2), *low = first, *high = last;
    while (low <= high) {
        while (before(*low, pivot))
            low++;
        while (before(pivot, *high))
            high--;
        if (low <= high) {
            word value = *low;
            *low++ = *high;
            *high-- = value;
        }
    }
    sort(first, high, before);
    sort(low, last, before);
}

static __attribute__((noinline)) int written(word number)
{
    int length = 0;
    do {
        text[length++] = (char)('0' + number % 10);
        number /= 10;
    } while (number != 0);
    return length;
}

static __attribute__((noinline)) word hashed(int length, word hash)
{
    for (int i = 0; i < length; i++)
        hash = (hash ^ (unsigned char)text[i]) * 16777619u;
    return hash;
}

void run(void)
{
    word hash = 2166136261u;
    for (int round = 0; round < ROUNDS; round++) {
        for (int i = 0; i < COUNT; i++) {
            word inputs[] = {hash, (word)i, hash >> 7};
            values[i] = evaluated(inputs);
            hash = hash * 1664525u + 1013904223u;
        }
        sort(values, values + COUNT - 1, round & 1 ? upwards : downwards);
        for (int i = 0; i < COUNT; i += 8)
            hash = hashed(written(values[i]), hash);
    }
    result = hash;
}
