/* SPDX-FileCopyrightText: 2026 Ravenbrick contributors
 * SPDX-License-Identifier: Apache-2.0
 *
 * ARM and Thumb code that call each other: directly over the linker's veneers, through pointers,
 * and as the last thing a function does.
 */

#define ARM __attribute__((target("arm"), noinline))
#define THUMB __attribute__((target("thumb"), noinline))

volatile int weights[8] = { 3, 1, 4, 1, 5, 9, 2, 6 };

ARM int arm_weigh(int count)
{
    int sum = 0;
    for (int place = 0; place < count; place++)
        sum += (weights[place & 7] << 1) + place;
    return sum;
}

THUMB int thumb_weigh(int count)
{
    int sum = 0;
    for (int place = 0; place < count; place++)
        sum += weights[place & 7] ^ place;
    return sum;
}

/* To the other state and back, in a loop. */
ARM int arm_to_thumb(void)
{
    int sum = 0;
    for (int count = 1; count < 6; count++)
        sum += thumb_weigh(count);
    return sum;
}

THUMB int thumb_to_arm(void)
{
    int sum = 0;
    for (int count = 1; count < 6; count++)
        sum += arm_weigh(count);
    return sum;
}

/* The last call is a branch; the way back is the caller's own. */
ARM int arm_tail(void)
{
    weights[0] = 7;
    return thumb_weigh(4);
}

THUMB int thumb_tail(void)
{
    weights[0] = 8;
    return arm_weigh(4);
}

/* There, back, there again. */
THUMB int thumb_over_arm(int count)
{
    return arm_to_thumb() + thumb_weigh(count & 3);
}

ARM int three_deep(void)
{
    return thumb_over_arm(2) + thumb_to_arm() + arm_tail() + thumb_tail();
}

/* A task that waits in a function of the other state. */
ARM void arm_wait(int count)
{
    weights[1] = count;
}

THUMB void thumb_task(void)
{
    for (int count = 0;; count++) {
        arm_wait(count);
        weights[2] = arm_weigh(3);
    }
}

/* Each round ends with a call of a function of the other state, which others call, too. */
THUMB void thumb_polls(void)
{
    while (arm_weigh(1) != 3)
        arm_wait(1);
}

static int (*const table[])(int) = { arm_weigh, thumb_weigh };

ARM int arm_pointers(void)
{
    int sum = 0;
    for (int place = 0; place < 2; place++)
        sum += table[place](place + 2);
    return sum;
}

THUMB int thumb_pointers(void)
{
    int sum = 0;
    for (int place = 0; place < 2; place++)
        sum += table[place](place + 2);
    return sum;
}

/* Which way is taken depends on the argument. */
THUMB int thumb_either(int which)
{
    if (which & 1)
        return arm_weigh(which & 7);
    return which < 0 ? thumb_weigh(3) : thumb_over_arm(which);
}

ARM int arm_either(int which)
{
    if (which & 1)
        return thumb_weigh(which & 7);
    return which < 0 ? arm_weigh(3) : thumb_either(which);
}
