/* SPDX-FileCopyrightText: 2026 Ravenbrick contributors
 * SPDX-License-Identifier: Apache-2.0
 *
 * Functions whose time depends on what their callers leave in frames and in memory.
 */

struct span {
    int first;
    int last;
};

__attribute__((noinline)) int added(const int *items, const struct span *span)
{
    int sum = 0;
    for (int place = span->first; place <= span->last; place++)
        sum += items[place];
    return sum;
}

/* Bounds of the loop lie in the caller's frame. */
int framed(int item)
{
    int items[8] = { item, item, item, item, item, item, item, item };
    struct span all = { 0, 7 }, some = { 2, 4 };
    return added(items, &all) + added(items, &some);
}

__attribute__((noinline)) int counted(int count)
{
    int sum = 0;
    for (int place = 0; place < count; place++)
        sum += place * place;
    return sum;
}

/* The callee's longest call is not its every call. */
int rising(void)
{
    int sum = 0;
    for (int count = 0; count < 10; count++)
        sum += counted(count);
    return sum;
}

static volatile unsigned char table[16];
static int depth[4];

void prepare(void)
{
    for (int place = 0; place < 16; place++)
        table[place] = (unsigned char)(place * 7 % 16);
    depth[2] = 6;
}

__attribute__((noinline)) int nested(int level)
{
    return level == 0 ? 1 : level + nested(level - 1);
}

/* How often depends on what `prepare` stored; one branch depends on nothing that is known. */
int stored(void)
{
    int sum = 0;
    for (int place = 0; table[place] != 9; place++)
        for (int count = table[place]; count > 0; count--)
            sum += count;
    return sum + nested(depth[2]);
}

int either(int which, int count)
{
    return which ? counted(count & 15) : 3;
}

int items[8];
static int highest_item;

/* Longest when each item is higher than those before it. */
int highest(void)
{
    highest_item = -0x7FFFFFFF;
    for (int place = 0; place < 8; place++)
        if (items[place] > highest_item)
            highest_item = items[place];
    return highest_item;
}

volatile int turns, sink;

/* A jump table whose index is a loop's counter: nothing else says where it ends. */
int turned(void)
{
    for (int kind = 0; kind < 8; kind++) {
        for (int turn = 0; turn < turns; turn++) {
            switch (kind) {
            case 0: sink += turn; break;
            case 1: sink *= 3; break;
            case 2: sink ^= turn; break;
            case 3: sink -= 7; break;
            case 4: sink |= turn; break;
            case 5: sink = turn - sink; break;
            case 6: sink = ~sink; break;
            case 7: sink <<= 1; break;
            }
        }
    }
    return sink;
}

/* The callee is known to the caller only; in Thumb code, a branch within the function calls it. */
__attribute__((noinline)) int through(int (*callee)(int), int count)
{
    int sum = 0;
    for (int turn = 0; turn < 4; turn++)
        sum += callee(count) + sink;
    return sum;
}

unsigned char portions[4];

/* Only one byte of the word is open. */
int portioned(void)
{
    int sum = 0;
    for (int place = 0; place < 4; place++)
        for (int count = portions[place]; count > 0; count--)
            sum += count;
    return sum;
}

void portion(void)
{
    portions[0] = 3;
    portions[2] = 5;
}

unsigned stairs;

/* One is compared before, the other after something is taken off. */
unsigned climbed(void)
{
    unsigned left = stairs, steps = 0, next;
    do {
        next = left - 2;
        if (left == 2)
            return steps;
        steps += sink;
        left = next;
    } while (left != 1);
    return steps + 1;
}

/* Calls itself as often as nobody knows. */
unsigned descended(unsigned left)
{
    return left == stairs ? 1 : descended(left - 1) + descended(left - 2);
}

volatile int signals;

/* How long it waits is not known; what it does then is. */
int awaited(void)
{
    while (signals & 1)
        sink += portions[0];
    return portioned();
}

volatile int marks, places[2];

/* One step takes what the other needs. */
int exclusive(void)
{
    if (marks >= 3) {
        marks -= 3;
        for (int turn = 0; turn < 9; turn++)
            places[0] += turn;
    }
    if (marks >= 3) {
        marks -= 3;
        for (int turn = 0; turn < 9; turn++)
            places[1] += turn;
    }
    return marks;
}

/* What a store to one of several places leaves alone beside them bounds a loop. */
int beside_a_store(unsigned which)
{
    unsigned char shape[8] = { 0 };
    int all[4] = { 1, 1, 1, 1 };
    struct span some = { 1, 2 };
    shape[which & 3] = 7;
    return added(all, &some) + shape[which & 7];
}
