/* SPDX-FileCopyrightText: 2026 Ravenbrick contributors */
/* SPDX-License-Identifier: Apache-2.0 */
/* Bodies of tasks that need most of their stack before the first wait, or after one. */

#define ANY __attribute__((noipa)) /* each call is made, whatever the function does */

static volatile int level;

ANY void wait(void)
{
        level = 0;
}

ANY static void touch(volatile char *object)
{
        object[0] = 1;
}

ANY static void deep(void)
{
        char large[400];
        touch(large);
        level = large[0];
}

ANY static void any_length(unsigned length)
{
        char any[length];
        touch(any);
        level = any[0];
}

void deep_before_jobs(void)
{
        deep();
        for (;;)
                wait();
}

void deep_in_jobs(void)
{
        for (;;) {
                wait();
                level = 1;
                wait();
                deep();
        }
}

void lost_before_jobs(void)
{
        any_length(level);
        for (;;)
                wait();
}

void lost_in_jobs(void)
{
        for (;;) {
                wait();
                any_length(level);
        }
}
