/* SPDX-FileCopyrightText: 2026 Ravenbrick contributors */
/* SPDX-License-Identifier: Apache-2.0 */
/* Bodies of tasks that have no wait in their own loop. */

static volatile int level;

__attribute__((noinline)) void wait(void)
{
    level = 0;
}

__attribute__((noinline)) static void work(int rounds)
{
    while (rounds-- > 0)
        level += rounds;
}

__attribute__((noinline)) static void never_back(void)
{
    work(3);
    for (;;)
        level++;
}

__attribute__((noinline)) static void waits_for_ever(void)
{
    for (;;)
        wait();
}

/* Each has a caller that goes on, so that no tail call joins them. */
void ends(void)
{
    work(5);
    level = 1;
}

void never_waits(void)
{
    work(2);
    never_back();
}

void waits_first(void)
{
    for (;;) {
        work(2);
        wait();
        if (level == 7)
            for (;;)
                level++;
    }
}

void waits_below(void)
{
    work(2);
    waits_for_ever();
}
