/* SPDX-FileCopyrightText: 2026 Ravenbrick contributors
 * SPDX-License-Identifier: Apache-2.0
 *
 * Protected actions around loops: one with a place that is never reached and leads into it, one
 * that a loop leaves and enters again, one around a call, and one without a bound.
 */

#define FUNCTION __attribute__((noinline))

int object;
volatile int weights[8] = { 3, 1, 4, 1, 5, 9, 2, 6 };
volatile int yields;

FUNCTION void enter_action(int *entered)
{
    *entered = 1;
}

FUNCTION void leave_action(int *left)
{
    *left = 0;
}

/* The compiler keeps the test of `failed`, which the analysis decides. */
FUNCTION int never_leads_into_the_loop(void)
{
    int sum = 0;
    int failed = 0;
    enter_action(&object);
    for (int place = 0; place < 8; place++) {
        sum += weights[place];
        if (failed == 1)
            sum -= place;
        sum ^= place;
    }
    leave_action(&object);
    return sum;
}

FUNCTION int leaves_in_the_loop(void)
{
    int sum = 0;
    enter_action(&object);
    for (int place = 0; place < 8; place++) {
        sum += weights[place];
        if (yields) {
            leave_action(&object);
            weights[0] = sum;
            enter_action(&object);
        }
        sum ^= place;
    }
    leave_action(&object);
    return sum;
}

/* How often the loop is repeated is known from the caller's frame only. */
FUNCTION int adds_up(const int *times)
{
    int sum = 0;
    for (int count = 0; count < *times; count++)
        sum += weights[count & 7];
    return sum;
}

FUNCTION void adds_up_in_an_action(void)
{
    int times = 50;
    enter_action(&object);
    weights[0] = adds_up(&times);
    leave_action(&object);
}

void adds_up_and_goes_on(void)
{
    int times = 50;
    enter_action(&object);
    weights[0] = adds_up(&times);
    leave_action(&object);
    for (;;)
        weights[1] = 1;
}

/* Called first: what it takes of the stack counts, however long it takes. */
FUNCTION int waits_in_an_action(int depth)
{
    volatile int frame[40];
    enter_action(&object);
    while (yields)
        frame[depth & 31] = weights[depth & 7];
    leave_action(&object);
    return frame[0];
}

void elaborates_and_goes_on(void)
{
    volatile int here = waits_in_an_action(3);
    for (;;)
        weights[here & 7] = here;
}
