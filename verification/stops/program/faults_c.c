/* SPDX-FileCopyrightText: 2026 Ravenbrick contributors */
/* SPDX-License-Identifier: Apache-2.0 */

/* What only C and assembly do. */

void fault_access(volatile int *address)
{
    *address = 1;
}

void fault_undefined(void)
{
    __asm__ volatile(".word 0xe7f000f0");
}

void fault_mask(int bits)
{
    __asm__ volatile("mrs r3, cpsr\n\torr r3, r3, %0\n\tmsr cpsr_c, r3" : : "r"(bits) : "r3");
}
