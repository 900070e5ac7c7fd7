/* SPDX-FileCopyrightText: 2026 Ravenbrick contributors */
/* SPDX-License-Identifier: Apache-2.0 */

/* What only C does. */

int failing_access(volatile int *address)
{
    return *address + 1; /* the access */
}

int failing_undefined(void)
{
    __asm__ volatile(".word 0xe7f000f0"); /* the undefined instruction */
    return 1;
}

int failing_jump(int (*target)(void))
{
    return target() + 1; /* the wild jump */
}
